#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "console/running_server.h"
#include "lodestone/console/served_files.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::RawClient;
using tests::RunningServer;

namespace {

int status_of(const std::string& answer) { return answer.size() < 12 ? 0 : std::stoi(answer.substr(9, 3)); }

}  // namespace

TEST_CASE("one connection asks for page after page") {
  RunningServer server;
  RawClient client(server.port());
  for (int i = 0; i < 3; ++i) {
    const std::string page = client.ask(RawClient::get("/"));
    CHECK(status_of(page) == 200);
    CHECK(page.find("<p>console</p>") != std::string::npos);
    CHECK(page.find("X-Content-Type-Options: nosniff\r\n") != std::string::npos);
    CHECK(status_of(client.ask(RawClient::get("/none"))) == 404);
  }
  const std::string head = client.ask("HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  CHECK(status_of(head) == 200);
  CHECK(head.find("Content-Length: 14\r\n") != std::string::npos);
  CHECK(status_of(client.ask(RawClient::get("/"))) == 200);  // and no body was in between
  client.send(RawClient::get("/") + RawClient::get("/none"));
  CHECK(status_of(client.ask("")) == 200);
  CHECK(status_of(client.ask("")) == 404);
  CHECK(status_of(client.ask(RawClient::get("/throw"))) == 500);
  client.send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  CHECK(status_of(client.rest()) == 200);
}

TEST_CASE("what is no request that a page makes is refused, and the connection ends") {
  RunningServer server;
  struct Case {
    std::string request;
    int status;
  };
  const std::string host = "Host: localhost\r\n";
  const std::vector<Case> cases = {
      {"POST / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello", 405},
      {"POST / HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n", 405},
      {"GET / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello", 413},
      {"GET / HTTP/1.1\r\n" + host + "Content-Length: 99999999999999\r\n\r\n", 413},
      {"GET / HTTP/1.1\r\n" + host + "Content-Length: x\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\n" + host + host + "\r\n", 400},
      {"GET / HTTP/1.1\r\n" + host + "Origin: http://localhost\r\nOrigin: http://localhost\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\n" + host + "Origin: \r\n\r\n", 400},
      {"GET / HTTP/1.1\r\n\r\n", 400},
      {"GET / HTTP/9.9\r\n" + host + "\r\n", 400},
      {"hello\r\n\r\n", 400},
      {std::string("\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", 11), 400},
      {"GET /" + std::string(20'000, 'a') + " HTTP/1.1\r\n" + host + "\r\n", 431},
      {"GET / HTTP/1.1\r\n" + host + "X: " + std::string(20'000, 'a') + "\r\n\r\n", 431},
      {RawClient::handshake("Host: localhost\r\n") + RawClient::frame(1, "early"), 400},
      {RawClient::handshake("Host: localhost\r\nOrigin: http://evil.example\r\n"), 403},
  };
  for (const Case& one : cases) {
    CAPTURE(one.request.substr(0, 60));
    RawClient client(server.port());
    client.send(one.request);
    const std::string answer = client.head();
    CHECK(status_of(answer) == one.status);
    if (one.status != 403) CHECK(answer.find("Connection: close\r\n") != std::string::npos);
  }
  CHECK(server.answers());
}

TEST_CASE("files go out in pieces, whole or in part") {
  const tests::TemporaryFolder folder;
  std::string content;
  for (int i = 0; content.size() < 3'000'000; ++i) content += std::to_string(i) + " ";
  std::ofstream(folder / "a.mp4") << content;
  const console::ServedFiles files({{"/recordings/", folder.path()}});
  RunningServer server({}, [&](const console::RequestHead& head) {
    return files.find(head).value_or(console::told(404, "there is none"));
  });
  RawClient client(server.port());
  const std::string whole = client.ask(RawClient::get("/recordings/a.mp4"));
  CHECK(whole.find("Accept-Ranges: bytes\r\n") != std::string::npos);
  CHECK((whole.size() > content.size() && whole.substr(whole.size() - content.size()) == content));
  const std::string part =
      client.ask(RawClient::get("/recordings/a.mp4", "Host: localhost\r\nRange: bytes=100000-299999\r\n"));
  CHECK(status_of(part) == 206);
  CHECK(part.find("Content-Range: bytes 100000-299999/" + std::to_string(content.size())) !=
        std::string::npos);
  CHECK(part.substr(part.size() - 200'000) == content.substr(100'000, 200'000));
  const std::string past = "Host: localhost\r\nRange: bytes=99999999-\r\n";
  CHECK(status_of(client.ask(RawClient::get("/recordings/a.mp4", past))) == 416);
  CHECK(status_of(client.ask(RawClient::get("/recordings/../a.mp4"))) == 404);
}

TEST_CASE("a client that does not take its file is not waited for") {
  const tests::TemporaryFolder folder;
  std::ofstream(folder / "a.mp4").close();
  std::filesystem::resize_file(folder / "a.mp4", 1'000'000'000);
  const console::ServedFiles files({{"/recordings/", folder.path()}});
  console::WebServerConfig config;
  config.stall_timeout_s = 0.2;
  RunningServer server(config, [&](const console::RequestHead& head) {
    return files.find(head).value_or(RunningServer::small_page()(head));
  });
  RawClient deaf(server.port(), 4096);
  deaf.send(RawClient::get("/recordings/a.mp4"));
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  CHECK(deaf.rest().size() < 1'000'000'000);
  CHECK(server.answers());
}

TEST_CASE("an answer of a file that has become shorter breaks off") {
  const tests::TemporaryFolder folder;
  std::ofstream(folder / "a.txt") << std::string(1000, 'a');
  const console::ServedFiles files({{"/runs/", folder.path()}});
  RunningServer server({}, [&](const console::RequestHead& head) {
    console::Response response = *files.find(head);
    std::filesystem::resize_file(folder / "a.txt", 10);
    return response;
  });
  RawClient client(server.port());
  client.send(RawClient::get("/runs/a.txt"));
  const std::string answer = client.rest();
  CHECK(answer.find("Content-Length: 1000\r\n") != std::string::npos);
  CHECK(answer.size() - answer.find("\r\n\r\n") < 100);
}
