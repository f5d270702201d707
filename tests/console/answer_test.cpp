#include "lodestone/console/answer.h"

#include <catch2/catch.hpp>
#include <stdexcept>

using namespace lodestone;
using console::RequestHead;

namespace {

console::Response page_of_answers(const RequestHead& head) {
  if (head.target == "/throw") throw std::runtime_error("no\ndisk");
  return console::told(200, head.target);
}

console::Response answered(const std::string& target, bool upgrade, const std::string& host = "localhost") {
  RequestHead head;
  head.method = "GET";
  head.target = target;
  head.host = host;
  head.upgrade = upgrade;
  return console::answer({false, ""}, page_of_answers, head);
}

}  // namespace

TEST_CASE("a request is refused, handed on, or answered by its page") {
  CHECK(answered("/", false, "evil.example").status == 403);
  CHECK(answered("/ws", true, "evil.example").status == 403);
  CHECK(answered("/ws", true).status == 101);
  CHECK(answered("/ws", false).status == 426);
  CHECK(answered("/", true).status == 404);
  CHECK(answered("/a", false).body == "/a\n");
}

TEST_CASE("a page that fails says why, in one line") {
  const console::Response response = answered("/throw", false);
  CHECK(response.status == 500);
  CHECK(response.body == "no\\ndisk\n");
}
