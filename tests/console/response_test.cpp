#include "lodestone/console/response.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace lodestone;

namespace {

std::vector<std::string> values_of(const std::vector<console::Header>& headers, const std::string& name) {
  std::vector<std::string> found;
  for (const console::Header& header : headers)
    if (header.name == name) found.push_back(header.value);
  return found;
}

}  // namespace

TEST_CASE("every answer keeps other sites away") {
  const auto headers = console::headers_of(console::told(404, "no"));
  CHECK(values_of(headers, "Content-Type") == std::vector<std::string>{"text/plain; charset=utf-8"});
  CHECK(values_of(headers, "X-Content-Type-Options") == std::vector<std::string>{"nosniff"});
  CHECK(values_of(headers, "Cache-Control") == std::vector<std::string>{"no-store"});
  CHECK(values_of(headers, "Referrer-Policy") == std::vector<std::string>{"no-referrer"});
  CHECK(values_of(headers, "Cross-Origin-Opener-Policy") == std::vector<std::string>{"same-origin"});
  CHECK(values_of(headers, "Cross-Origin-Resource-Policy") == std::vector<std::string>{"same-origin"});
  const std::string policy = values_of(headers, "Content-Security-Policy").at(0);
  for (const char* part :
       {"default-src 'self'", "script-src 'self';", "frame-ancestors 'none'", "form-action 'none'"})
    CHECK(policy.find(part) != std::string::npos);
  CHECK(policy.find("unsafe") == std::string::npos);
}

TEST_CASE("what an answer says itself is said once") {
  console::Response response = console::told(200, "");
  response.headers = {{"Content-Security-Policy", "sandbox"}, {"Allow", "GET"}};
  const auto headers = console::headers_of(response);
  CHECK(values_of(headers, "Content-Security-Policy") == std::vector<std::string>{"sandbox"});
  CHECK(values_of(headers, "Allow") == std::vector<std::string>{"GET"});
}
