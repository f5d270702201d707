#include <catch2/catch.hpp>

#include "console/running_server.h"

using namespace lodestone;
using tests::RawClient;
using tests::RunningServer;

namespace {

/// Does not wait long for clients that are told to go and stay.
console::WebServerConfig brisk() {
  console::WebServerConfig config;
  config.farewell_timeout_s = 0.2;
  return config;
}

}  // namespace

TEST_CASE("texts are heard in order, whole or in parts, and answered") {
  RunningServer server(brisk());
  RawClient client(server.port());
  REQUIRE(client.become_socket());
  REQUIRE(server.opened(1));
  client.send(RawClient::frame(1, "a") + RawClient::frame(1, "b", false) + RawClient::frame(9, "ping") +
              RawClient::frame(0, "c", false) + RawClient::frame(0, "d") + RawClient::frame(1, ""));
  CHECK(client.hear_text() == "heard a");
  CHECK(client.hear()->payload == "ping");
  CHECK(client.hear_text() == "heard bcd");
  CHECK(client.hear_text() == "heard ");
  const std::string longest(65536, 'x');
  client.say(longest);
  CHECK(client.hear_text() == "heard " + longest);
  client.send(RawClient::frame(8, ""));
  CHECK(client.hear()->kind == 8);
  CHECK(server.closed(1));
}

TEST_CASE("images come in one piece") {
  RunningServer server;
  RawClient client(server.port());
  REQUIRE(client.become_socket());
  REQUIRE(server.opened(1));
  const auto image = std::make_shared<const std::string>(300'000, '\xff');
  server->send(server.last_opened(), image);
  const auto frame = client.hear();
  REQUIRE(frame);
  CHECK(frame->kind == 2);
  CHECK(frame->payload == *image);
}

TEST_CASE("what is too much, or no text, is told so and closed") {
  RunningServer server(brisk());
  struct Case {
    std::string frames;
    std::string said;
  };
  std::string flood;
  for (int i = 0; i < 2000; ++i) flood += RawClient::frame(1, "x");
  const std::string large(40'000, 'x');
  const std::vector<Case> cases = {
      {RawClient::frame(1, std::string(65'537, 'x')), "bye: a message of more than 65536 bytes"},
      {RawClient::frame(1, std::string(70'000, 'x'), true, 1ULL << 62U),
       "bye: a message of more than 65536 bytes"},
      {RawClient::frame(1, large, false) + RawClient::frame(0, large),
       "bye: a message of more than 65536 bytes"},
      {RawClient::frame(2, "binary"), "bye: a message that is not text"},
      {RawClient::frame(1, "throw"), "bye: it does not like this"},
      {flood, "bye: more than 100 messages a second"},
  };
  std::size_t closed = 0;
  for (const Case& one : cases) {
    RawClient client(server.port());
    REQUIRE(client.become_socket());
    client.send(one.frames);
    std::string last;
    for (std::string heard = client.hear_text(); !heard.empty(); heard = client.hear_text()) last = heard;
    CHECK(last == one.said);
    CHECK(server.closed(++closed));
  }
  CHECK(server.heard_so_far() < 1000);
  CHECK(server.answers());
}

TEST_CASE("what is no WebSocket any more is closed") {
  RunningServer server(brisk());
  std::string pings;
  for (int i = 0; i < 2000; ++i) pings += RawClient::frame(9, "");
  std::size_t closed = 0;
  for (const std::string& bytes : {std::string("\x81\x01x", 3),                 // not masked
                                   std::string("\xf1\x80\x00\x00\x00\x00", 6),  // reserved bits
                                   RawClient::frame(1, "\xff\xfe"),             // no UTF-8
                                   RawClient::frame(0, "x"),                    // goes on with nothing
                                   RawClient::frame(9, std::string(200, 'x')), RawClient::frame(3, "x"),
                                   std::string(100, '\0'), pings}) {
    RawClient client(server.port());
    REQUIRE(client.become_socket());
    client.send(bytes);
    client.rest();
    CHECK(server.closed(++closed));
  }
  CHECK(server.heard_so_far() == 0);
}

TEST_CASE("a client that is closed hears what was sent before, and a last word") {
  RunningServer server(brisk());
  RawClient client(server.port());
  REQUIRE(client.become_socket());
  REQUIRE(server.opened(1));
  for (int i = 0; i < 20; ++i) server->send(server.last_opened(), std::to_string(i));
  server->close(server.last_opened(), "the last");
  server->send(server.last_opened(), "too late");
  for (int i = 0; i < 20; ++i) CHECK(client.hear_text() == std::to_string(i));
  CHECK(client.hear_text() == "the last");
  CHECK(client.hear()->kind == 8);
  client.rest();
  CHECK(server.closed(1));
  server->send(server.last_opened(), "nobody is there");
  server->close(server.last_opened(), "");
  CHECK(server.answers());
}

TEST_CASE("a client that does not answer a farewell, or nothing at all, is not waited for") {
  console::WebServerConfig config;
  config.farewell_timeout_s = 0.1;
  config.client_timeout_s = 0.5;
  RunningServer server(config);
  RawClient deaf(server.port());
  REQUIRE(deaf.become_socket());
  REQUIRE(server.opened(1));
  server->close(server.last_opened(), "bye");
  CHECK(server.closed(1));
  RawClient silent(server.port());  // answers no ping
  REQUIRE(silent.become_socket());
  CHECK(server.closed(2));
}

TEST_CASE("what waits for a client that does not read is bounded") {
  console::WebServerConfig config;
  config.write_timeout_s = 1000.0;
  config.client_timeout_s = 1000.0;
  const auto large = std::make_shared<const std::string>(1'000'000, 'x');
  SECTION("in number") {
    config.max_queued_bytes = std::size_t{1} << 40U;
    RunningServer server(config);
    RawClient deaf(server.port(), 4096);
    REQUIRE(deaf.become_socket());
    REQUIRE(server.opened(1));
    for (int i = 0; i < 100; ++i) server->send(server.last_opened(), large);
    CHECK(server.closed(1));
  }
  SECTION("in size") {
    config.max_queued = 1'000'000;
    RunningServer server(config);
    RawClient deaf(server.port(), 4096);
    REQUIRE(deaf.become_socket());
    REQUIRE(server.opened(1));
    for (int i = 0; i < 20; ++i) server->send(server.last_opened(), large);
    CHECK(server.closed(1));
  }
  SECTION("in time") {
    config.write_timeout_s = 0.2;
    RunningServer server(config);
    RawClient deaf(server.port(), 4096);
    REQUIRE(deaf.become_socket());
    REQUIRE(server.opened(1));
    server->send(server.last_opened(), std::make_shared<const std::string>(30'000'000, 'x'));
    CHECK(server.closed(1));
  }
}
