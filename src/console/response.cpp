#include "lodestone/console/response.h"

#include <algorithm>

namespace lodestone::console {

Response told(int status, const std::string& text) {
  Response response;
  response.status = status;
  response.body = text + "\n";
  return response;
}

std::vector<Header> headers_of(const Response& response) {
  static const std::vector<Header> kAlways = {
      {"Content-Security-Policy",
       "default-src 'self'; img-src 'self' blob: data:; media-src 'self'; style-src 'self'; script-src "
       "'self'; "
       "connect-src 'self'; object-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-store"},
  };
  std::vector<Header> all = {{"Content-Type", response.content_type}};
  all.insert(all.end(), response.headers.begin(), response.headers.end());
  for (const Header& header : kAlways)
    if (std::none_of(all.begin(), all.end(), [&](const Header& own) { return own.name == header.name; }))
      all.push_back(header);
  return all;
}

}  // namespace lodestone::console
