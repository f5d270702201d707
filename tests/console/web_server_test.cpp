#include "lodestone/console/web_server.h"

#include <catch2/catch.hpp>
#include <future>

#include "console/running_server.h"

using namespace lodestone;
using tests::RawClient;
using tests::RunningServer;

TEST_CASE("pages and sockets are kept from other sites") {
  RunningServer server;
  const std::string here = "localhost:" + std::to_string(server.port());
  struct Case {
    std::string headers;
    std::string page;
    std::string socket;
  };
  const std::vector<Case> cases = {
      {"Host: " + here + "\r\n", "200", "101"},
      {"Host: " + here + "\r\nOrigin: http://" + here + "\r\n", "200", "101"},
      {"Host: localhost:1234\r\nOrigin: http://localhost:1234\r\n", "200", "101"},
      {"Host: " + here + "\r\nOrigin: http://localhost:1234\r\n", "403", "403"},
      {"Host: " + here + "\r\nOrigin: http://evil.example\r\n", "403", "403"},
      {"Host: evil.example\r\n", "403", "403"},
      {"Host: " + here + "\r\nSec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\n", "200", "403"},
      {"Host: " + here + "\r\nSec-Fetch-Site: same-site\r\nSec-Fetch-Mode: websocket\r\n", "403", "403"},
  };
  for (const Case& one : cases) {
    CAPTURE(one.headers);
    CHECK(RawClient(server.port()).ask(RawClient::get("/", one.headers)).substr(9, 3) == one.page);
    CHECK(RawClient(server.port()).ask(RawClient::handshake(one.headers)).substr(9, 3) == one.socket);
  }
  CHECK(RawClient(server.port()).ask(RawClient::get("/ws")).substr(9, 3) == "426");
  CHECK(RawClient(server.port()).ask(RawClient::handshake("Host: localhost\r\n", "/")).substr(9, 3) == "404");
}

TEST_CASE("the way in beyond the loopback") {
  const std::string token = console::draw_token();
  RunningServer server({}, RunningServer::small_page(), {true, token});
  const std::string host = "Host: rig.example\r\n";
  RawClient client(server.port());
  CHECK(client.ask(RawClient::get("/", host)).substr(9, 3) == "403");
  CHECK(RawClient(server.port()).ask(RawClient::handshake(host)).substr(9, 3) == "403");
  const std::string in = RawClient(server.port()).ask(RawClient::get("/?token=" + token, host));
  CHECK(in.substr(9, 3) == "303");
  CHECK(in.find("Location: /\r\n") != std::string::npos);
  const std::size_t at = in.find("Set-Cookie: ") + 12;
  const std::string cookie = "Cookie: " + in.substr(at, in.find(';', at) - at) + "\r\n";
  CHECK(RawClient(server.port()).ask(RawClient::get("/", host + cookie)).substr(9, 3) == "200");
  CHECK(RawClient(server.port()).ask(RawClient::handshake(host + cookie)).substr(9, 3) == "101");
}

TEST_CASE("a page that takes long delays no message") {
  std::promise<void> done;
  RunningServer server({}, [&](const console::RequestHead&) {
    done.get_future().wait();
    return console::told(200, "at last");
  });
  RawClient socket(server.port());
  REQUIRE(socket.become_socket());
  RawClient page(server.port());
  page.send(RawClient::get("/"));
  for (int i = 0; i < 50; ++i) {
    socket.say(std::to_string(i));
    CHECK(socket.hear_text() == "heard " + std::to_string(i));
  }
  done.set_value();
  CHECK(page.ask("").rfind("HTTP/1.1 200", 0) == 0);
}

TEST_CASE("a server that nobody asks ends") {
  for (int i = 0; i < 20; ++i) const RunningServer server;
  RunningServer server;
  server.end();
  CHECK(server.closed_so_far() == 0);
}
