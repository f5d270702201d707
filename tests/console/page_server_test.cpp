#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "console/running_server.h"
#include "lodestone/common/error.h"

using namespace lodestone;
using tests::RawClient;
using tests::RunningServer;

TEST_CASE("a request that does not come to its end is not waited for") {
  console::WebServerConfig config;
  config.request_timeout_s = 0.2;
  RunningServer server(config);
  RawClient nothing(server.port());
  RawClient half(server.port());
  half.send("GET / HTTP/1.1\r\nHost: loc");
  RawClient idle(server.port());
  CHECK(idle.ask(RawClient::get("/")).rfind("HTTP/1.1 200", 0) == 0);
  CHECK(nothing.rest().empty());
  CHECK(half.rest().empty());
  CHECK(idle.rest().empty());
  CHECK(server.answers());
}

TEST_CASE("whoever opens connections and says nothing loses the oldest, and keeps nobody out") {
  console::WebServerConfig config;
  config.max_silent = 3;
  RunningServer server(config);
  std::vector<std::unique_ptr<RawClient>> silent;
  for (int i = 0; i < 10; ++i) {
    silent.push_back(std::make_unique<RawClient>(server.port()));
    silent.back()->send("GET / HTTP/1.1\r\n");
  }
  for (int i = 0; i < 7; ++i) CHECK(silent[static_cast<std::size_t>(i)]->rest().empty());
  CHECK(server.answers());
  CHECK(silent.back()->ask("Host: localhost\r\n\r\n").rfind("HTTP/1.1 200", 0) == 0);
}

TEST_CASE("whoever keeps connections loses the one that has waited longest") {
  console::WebServerConfig config;
  config.max_connections = 4;
  RunningServer server(config);
  std::vector<std::unique_ptr<RawClient>> kept;
  for (int i = 0; i < 6; ++i) {
    kept.push_back(std::make_unique<RawClient>(server.port()));
    CHECK(kept.back()->ask(RawClient::get("/")).rfind("HTTP/1.1 200", 0) == 0);
  }
  CHECK(kept[0]->rest().empty());
  CHECK(kept[1]->rest().empty());
  for (std::size_t i = 2; i < kept.size(); ++i)
    CHECK(kept[i]->ask(RawClient::get("/")).rfind("HTTP/1.1 200", 0) == 0);
}

TEST_CASE("a port that is taken, and an address that is none, are refused by name") {
  const RunningServer server;
  console::WebServerConfig config;
  config.port = server.port();
  const auto said_of = [&] {
    try {
      const RunningServer second(config);
    } catch (const common::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string taken = said_of();
  CHECK(taken.find("127.0.0.1 port " + std::to_string(server.port())) != std::string::npos);
  CHECK(taken.find("--port") != std::string::npos);
  CHECK_THROWS_AS(RunningServer(config), common::IoError);
  config.port = 0;
  config.address = "192.0.2.1";  // nobody's
  CHECK(said_of().find("192.0.2.1") != std::string::npos);
  CHECK_THROWS_AS(RunningServer(config), common::IoError);
  config.address = "here";
  CHECK(said_of().find("--listen") != std::string::npos);
  CHECK_THROWS_AS(RunningServer(config), common::ConfigError);
}

TEST_CASE("the port is free for the next server at once") {
  console::WebServerConfig config;
  {
    RunningServer server;
    config.port = server.port();
    RawClient client(server.port());
    REQUIRE(client.become_socket());
    server.end();
  }
  RunningServer again(config);
  CHECK(again.port() == config.port);
  CHECK(again.answers());
}
