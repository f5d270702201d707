#include <catch2/catch.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "console/running_server.h"

using namespace lodestone;
using tests::RawClient;
using tests::RunningServer;

namespace {

std::vector<std::unique_ptr<RawClient>> open_sockets(RunningServer& server, std::size_t count) {
  std::vector<std::unique_ptr<RawClient>> clients;
  for (std::size_t i = 0; i < count; ++i) {
    clients.push_back(std::make_unique<RawClient>(server.port()));
    REQUIRE(clients.back()->become_socket());
  }
  REQUIRE(server.opened(count));
  return clients;
}

}  // namespace

TEST_CASE("one that never reads delays none of ten others") {
  console::WebServerConfig config;
  config.max_queued_bytes = std::size_t{1} << 30U;
  RunningServer server(config);
  RawClient deaf(server.port(), 4096);
  REQUIRE(deaf.become_socket());
  REQUIRE(server.opened(1));
  const console::ClientId deaf_id = server.last_opened();
  server->send(deaf_id, std::make_shared<const std::string>(30'000'000, 'x'));  // never gets through
  const auto others = open_sockets(server, 10);
  for (int round = 0; round < 50; ++round) {
    server->send(deaf_id, "more");
    for (const auto& client : others) client->say(std::to_string(round));
    for (const auto& client : others) CHECK(client->hear_text() == "heard " + std::to_string(round));
  }
  CHECK(server.closed_so_far() == 0);  // not yet: 51 messages wait for it
}

TEST_CASE("there is room for so many clients, and again when one is gone") {
  console::WebServerConfig config;
  config.max_clients = 3;
  RunningServer server(config);
  auto clients = open_sockets(server, 3);
  RawClient fourth(server.port());
  CHECK(fourth.ask(RawClient::handshake()).rfind("HTTP/1.1 503", 0) == 0);
  CHECK(server.answers());
  clients.pop_back();
  REQUIRE(server.closed(1));
  RawClient fifth(server.port());
  CHECK(fifth.become_socket());
  // A handshake that fails takes no place for good.
  clients.pop_back();
  REQUIRE(server.closed(2));
  for (int i = 0; i < 10; ++i) {
    RawClient wrong(server.port());
    wrong.send(RawClient::get("/ws",
                              "Host: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                              "Sec-WebSocket-Version: 8\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"));
    CHECK(wrong.head().rfind("HTTP/1.1 4", 0) == 0);
    wrong.rest();
  }
  RawClient sixth(server.port());
  CHECK(sixth.become_socket());
}

TEST_CASE("any thread may send, each in its order") {
  console::WebServerConfig config;
  config.max_queued = 10'000;
  RunningServer server(config);
  const auto clients = open_sockets(server, 1);
  const console::ClientId id = server.last_opened();
  std::vector<std::thread> threads;
  for (char name = 'a'; name < 'e'; ++name)
    threads.emplace_back([&server, id, name] {
      for (int i = 0; i < 500; ++i) server->send(id, name + std::to_string(i));
    });
  std::vector<int> next(4, 0);
  for (int i = 0; i < 2000; ++i) {
    const std::string text = clients[0]->hear_text();
    REQUIRE(text.size() > 1);
    CHECK(std::stoi(text.substr(1)) == next.at(static_cast<std::size_t>(text[0] - 'a'))++);
  }
  for (std::thread& thread : threads) thread.join();
}

TEST_CASE("the end of the server is told to those who listen, and waits for nobody") {
  RunningServer server;
  const auto clients = open_sockets(server, 5);
  RawClient deaf(server.port(), 4096);
  REQUIRE(deaf.become_socket());
  REQUIRE(server.opened(6));
  server->send(server.last_opened(), std::make_shared<const std::string>(30'000'000, 'x'));
  RawClient half(server.port());
  half.send("GET / HTTP/1.1\r\n");
  RawClient handshake(server.port());
  handshake.send(RawClient::handshake().substr(0, 50));
  server.end();
  CHECK(server.closed(6));
  for (const auto& client : clients) {
    const auto farewell = client->hear();
    REQUIRE(farewell);
    CHECK(farewell->kind == 8);
    CHECK(farewell->payload == std::string("\x03\xe9", 2));  // 1001: going away
    CHECK(client->rest().empty());
  }
  CHECK(half.rest().empty());
}
