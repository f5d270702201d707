#include "lodestone/console/access.h"

#include <catch2/catch.hpp>
#include <set>

#include "lodestone/common/error.h"

using namespace lodestone;
using console::Access;
using console::RequestHead;

namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

RequestHead asked(const std::string& host, const std::string& origin = "", const std::string& target = "/") {
  RequestHead head;
  head.method = "GET";
  head.target = target;
  head.host = host;
  head.origin = origin;
  return head;
}

int status(const Access& access, const RequestHead& head) {
  const auto refusal = access.judge(head);
  if (refusal) CHECK_FALSE(refusal->body.empty());
  return refusal ? refusal->status : 200;
}

}  // namespace

TEST_CASE("on the loopback only names of this machine are a host") {
  const Access access(false, "");
  for (const char* host : {"localhost", "localhost:8080", "LocalHost:1", "127.0.0.1", "127.0.0.1:65535",
                           "[::1]", "[::1]:8080"}) {
    CAPTURE(host);
    CHECK(status(access, asked(host)) == 200);
  }
  for (const char* host : {"evil.example", "evil.example:8080", "localhost.evil.example",
                           "127.0.0.1.evil.example", "127.0.0.2", "localhost.", "0.0.0.0:8080", "[::]:8080",
                           "[::ffff:127.0.0.1]", "127.1", "2130706433", "0x7f000001"}) {
    CAPTURE(host);
    CHECK(status(access, asked(host)) == 403);
  }
  for (const char* host : {"", ":", ":80", "localhost:", "localhost:x", "localhost:123456", "localhost:80:80",
                           "user@localhost", "localhost/", "localhost, evil.example", "[::1", "[]", "[::1]x",
                           "local\xff"
                           "host",
                           " localhost"}) {
    CAPTURE(host);
    CHECK(status(access, asked(host)) == 400);
  }
}

TEST_CASE("a page may only ask where it comes from, also by way of a tunnel, and a program without one may") {
  const Access access(false, "");
  struct Case {
    const char* host;
    const char* origin;
    int status;
  };
  const Case cases[] = {
      {"localhost:8080", "", 200},
      {"localhost:8080", "http://localhost:8080", 200},
      {"localhost:9999", "http://localhost:9999", 200},  // a tunnel
      {"localhost", "http://localhost", 200},
      {"localhost:80", "http://localhost", 200},
      {"localhost", "https://localhost:443", 200},
      {"[::1]:8080", "http://[::1]:8080", 200},
      {"localhost:8080", "http://localhost:3000", 403},  // another program on this machine
      {"localhost:8080", "http://localhost", 403},
      {"localhost:8080", "http://127.0.0.1:8080", 403},
      {"localhost:8080", "http://evil.example", 403},
      {"localhost:8080", "http://evil.example:8080", 403},
      {"localhost:8080", "http://localhost:8080.evil.example", 403},
      {"localhost:8080", "http://localhost:8080/", 403},
      {"localhost:8080", "http://localhost:8080 ", 403},
      {"localhost:8080", "null", 403},
      {"localhost:8080", "file://", 403},
      {"localhost:8080", "ftp://localhost:8080", 403},
      {"localhost:8080", "localhost:8080", 403},
      {"evil.example:8080", "http://evil.example:8080", 403},  // a name that resolves to this machine
      {"evil.example:8080", "http://localhost:8080", 403},
  };
  for (const Case& one : cases) {
    for (const bool upgrade : {false, true}) {
      RequestHead head = asked(one.host, one.origin, upgrade ? "/ws" : "/");
      head.upgrade = upgrade;
      CAPTURE(one.host, one.origin, upgrade);
      CHECK(status(access, head) == one.status);
    }
  }
}

TEST_CASE("a page of another site only opens the front door") {
  const Access access(false, "");
  struct Case {
    const char* site;
    const char* mode;
    const char* target;
    int status;
  };
  const Case cases[] = {
      {"same-origin", "cors", "/ws", 200},       {"none", "navigate", "/runs/a/report.html", 200},
      {"cross-site", "navigate", "/", 200},      {"cross-site", "navigate", "/?token=0", 200},
      {"same-site", "navigate", "/", 200},       {"cross-site", "no-cors", "/", 403},
      {"cross-site", "navigate", "/runs/", 403}, {"same-site", "websocket", "/ws", 403},
      {"cross-site", "websocket", "/ws", 403},   {"same-site", "no-cors", "/runs/a.png", 403},
      {"odd", "navigate", "/runs/a.html", 403},
  };
  for (const Case& one : cases) {
    RequestHead head = asked("localhost", "", one.target);
    head.fetch_site = one.site;
    head.fetch_mode = one.mode;
    CAPTURE(one.site, one.mode, one.target);
    CHECK(status(access, head) == one.status);
  }
  RequestHead socket = asked("localhost", "", "/");
  socket.fetch_site = "cross-site";
  socket.fetch_mode = "navigate";
  socket.upgrade = true;
  CHECK(status(access, socket) == 403);
}

TEST_CASE("requests read, and say so of what they may do") {
  const Access access(false, "");
  RequestHead head = asked("localhost");
  head.method = "HEAD";
  CHECK(status(access, head) == 200);
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "get", ""}) {
    head.method = method;
    CAPTURE(method);
    const auto refusal = access.judge(head);
    REQUIRE(refusal);
    CHECK(refusal->status == 405);
    CHECK(refusal->headers.at(0).value == "GET, HEAD");
  }
  for (const char* target : {"", "*", "http://localhost/", "runs/"})
    CHECK(status(access, asked("localhost", "", target)) == 400);
}

TEST_CASE("beyond the loopback the token opens the door, and its cookie everything else") {
  const Access access(true, kToken);
  const auto in = access.judge(asked("rig.example:8080", "", "/?token=" + kToken));
  REQUIRE(in);
  CHECK(in->status == 303);
  CHECK(in->headers.at(0).value == "/");
  CHECK(in->headers.at(1).value == "lodestone=" + kToken + "; HttpOnly; SameSite=Strict; Path=/");

  RequestHead socket = asked("rig.example:8080", "http://rig.example:8080", "/ws");
  socket.upgrade = true;
  for (RequestHead head :
       {asked("rig.example:8080"), asked("rig.example:8080", "", "/runs/a.html"), socket}) {
    CAPTURE(head.target);
    head.cookie = "";
    CHECK(status(access, head) == 403);
    for (const std::string& cookie : {"lodestone=" + kToken, "a=b; lodestone=" + kToken,
                                      "lodestone=old; lodestone=" + kToken + "; c=d"}) {
      head.cookie = cookie;
      CAPTURE(cookie);
      CHECK(status(access, head) == 200);
    }
    for (const std::string& cookie :
         {std::string("lodestone="), "lodestone=" + kToken.substr(1), "lodestone=" + kToken + "0",
          "lodestone=1" + kToken.substr(1), "xlodestone=" + kToken, "token=" + kToken, "Lodestone=" + kToken,
          "lodestone=\"" + kToken + "\"", std::string(";;; ;")}) {
      head.cookie = cookie;
      CAPTURE(cookie);
      CHECK(status(access, head) == 403);
    }
  }
  for (const std::string& target :
       {std::string("/?token="), "/?token=1" + kToken.substr(1), "/?token=" + kToken + "&a",
        "/x?token=" + kToken, "/?a=b&token=" + kToken})
    CHECK(status(access, asked("rig.example", "", target)) == 403);
}

TEST_CASE("the token does not let a page of another site drive") {
  const Access access(true, kToken);
  RequestHead head = asked("rig.example:8080", "http://evil.example", "/ws");
  head.cookie = "lodestone=" + kToken;
  head.upgrade = true;
  CHECK(status(access, head) == 403);
  head.origin = "";  // a program
  CHECK(status(access, head) == 200);
  head.target = "/?token=" + kToken;  // a socket is opened by nobody's link
  head.cookie = "";
  CHECK(status(access, head) == 403);
}

TEST_CASE("tokens are drawn anew, and others refused") {
  std::set<std::string> drawn;
  for (int i = 0; i < 100; ++i) {
    drawn.insert(console::draw_token());
    CHECK_NOTHROW(Access(true, *drawn.rbegin()));
  }
  CHECK(drawn.size() == 100);
  CHECK_THROWS_AS(Access(true, ""), common::LogicFault);
  CHECK_THROWS_AS(Access(true, std::string(32, 'x')), common::LogicFault);
  CHECK_THROWS_AS(Access(false, kToken), common::LogicFault);
}

TEST_CASE("addresses of the loopback are known, and everything else is beyond it") {
  for (const char* address : {"localhost", "127.0.0.1", "127.1.2.3", "::1"})
    CHECK(console::is_loopback(address));
  for (const char* address : {"0.0.0.0", "::", "192.168.1.2", "::ffff:127.0.0.1", "127.0.0.1.example", ""})
    CHECK_FALSE(console::is_loopback(address));
}
