#include "console/running_server.h"
#include "console/sample_messages.h"
#include "fuzz/fuzz.h"

using namespace lodestone;
using tests::RawClient;

namespace {

/// What a browser sends on one connection: pages, or a handshake and messages.
std::vector<std::string> good_streams() {
  const std::string browser =
      "Host: localhost:8080\r\nOrigin: http://localhost:8080\r\nSec-Fetch-Site: same-origin\r\n"
      "Sec-Fetch-Mode: cors\r\nRange: bytes=0-5\r\nCookie: a=b\r\nAccept: */*\r\n";
  return {RawClient::get("/", browser) + RawClient::get("/none", browser),
          "HEAD / HTTP/1.0\r\n" + browser + "\r\n",
          "POST / HTTP/1.1\r\n" + browser + "Content-Length: 5\r\n\r\nhello",
          "POST / HTTP/1.1\r\n" + browser + "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n",
          RawClient::handshake(browser)};
}

std::string good_frames(tests::Spoiler& spoiler, const std::vector<std::string>& messages) {
  std::string frames;
  for (std::size_t count = 1 + spoiler.below(4); count > 0; --count) {
    const std::string& message = spoiler.one_of(messages);
    const std::size_t half = spoiler.below(message.size());
    switch (spoiler.below(4)) {
      case 0:
        frames +=
            RawClient::frame(1, message.substr(0, half), false) + RawClient::frame(0, message.substr(half));
        break;
      case 1:
        frames += RawClient::frame(9, "ping");
        break;
      default:
        frames += RawClient::frame(1, message);
    }
  }
  return frames + RawClient::frame(8, "");
}

}  // namespace

TEST_CASE("a spoiled stream of bytes ends, and the server goes on", "[soak]") {
  const tests::Soak soak("spoiled streams to the web server", 1000, 100'000);
  tests::RunningServer server;
  tests::Spoiler spoiler(soak.seed(), "streams");
  const std::vector<std::string> streams = good_streams();
  const std::vector<std::string> messages = tests::sample_messages();
  RawClient watcher(server.port());
  REQUIRE(watcher.become_socket());
  std::string handshake;
  std::string bytes;
  std::int64_t sent = 0;
  std::int64_t answered = 0;
  tests::fuzz(
      soak,
      [&] {
        const bool to_socket = spoiler.below(2) == 0;
        handshake = to_socket ? RawClient::handshake() : "";
        bytes = to_socket ? good_frames(spoiler, messages) : spoiler.one_of(streams);
        bytes = spoiler.bytes(bytes, to_socket ? good_frames(spoiler, messages) : spoiler.one_of(streams));
      },
      [&] {
        RawClient client(server.port());
        if (!handshake.empty()) {
          client.send(handshake);
          if (client.head().rfind("HTTP/1.1 101", 0) != 0) FAIL("no socket any more");
        }
        client.send(bytes);
        client.end_sending();
        if (!client.rest().empty()) ++answered;
        if (++sent % 500 != 0) return;
        if (!server.answers()) FAIL("no page any more");
        watcher.say("still there?");
        if (watcher.hear_text() != "heard still there?") FAIL("no answer any more");
      });
  CHECK(answered > soak.count() / 4);
}
