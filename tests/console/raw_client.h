#pragma once
// A client of the web server that can do everything wrong: it sends the bytes that it is given.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace lodestone::tests {

inline constexpr int kPatience_ms = 20'000;  // generous: nothing here measures speed

struct Frame {
  int kind = 0;  ///< 1 text, 2 binary, 8 close, 9 ping, 10 pong
  std::string payload;
};

class RawClient {
 public:
  /// `receive_buffer_bytes`: of the system's; 0 leaves it to the system.
  explicit RawClient(unsigned short port, int receive_buffer_bytes = 0)
      : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_buffer_bytes > 0)
      ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes);
    const linger at_once{1, 0};  // leaves no trace, so that thousands may follow
    ::setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    const int yes = 1;
    ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no connection to port " + std::to_string(port));
  }
  ~RawClient() { ::close(descriptor_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  /// Whether the other side took it.
  bool send(const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      pollfd wanted{descriptor_, POLLOUT, 0};
      if (::poll(&wanted, 1, kPatience_ms) <= 0) return false;
      const ssize_t n =
          ::send(descriptor_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n < 0) return false;
      sent += static_cast<std::size_t>(n);
    }
    return true;
  }
  void end_sending() { ::shutdown(descriptor_, SHUT_WR); }

  /// Reads until there is `count` bytes; whether there are.
  bool fill(std::size_t count) {
    while (received_.size() < count)
      if (!read_some()) return false;
    return true;
  }
  /// All until the other side closes; throws where it does not.
  std::string rest() {
    while (read_some()) {
    }
    if (!ended_) throw std::runtime_error("the connection is still open");
    return std::exchange(received_, {});
  }
  /// The headers of an answer, with the empty line; what there is where the other side closes before.
  std::string head() {
    std::size_t end = std::string::npos;
    while ((end = received_.find("\r\n\r\n")) == std::string::npos)
      if (!read_some()) return std::exchange(received_, {});
    return take(end + 4);
  }
  std::string body(std::size_t count) {
    fill(count);
    return take(std::min(count, received_.size()));
  }

  /// Asks for a page, and gives the whole answer.
  std::string ask(const std::string& request) {
    send(request);
    std::string answer = head();
    const std::size_t at = answer.find("Content-Length: ");
    if (at != std::string::npos && request.rfind("HEAD", 0) != 0)
      answer += body(std::stoul(answer.substr(at + 16)));
    return answer;
  }
  static std::string get(const std::string& target, const std::string& headers = "Host: localhost\r\n") {
    return "GET " + target + " HTTP/1.1\r\n" + headers + "\r\n";
  }

  /// The request of a WebSocket.
  static std::string handshake(const std::string& headers = "Host: localhost\r\n",
                               const std::string& target = "/ws") {
    return get(target, headers +
                           "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n");
  }
  /// A WebSocket from here on; whether the server agrees.
  bool become_socket() { return ask(handshake()).rfind("HTTP/1.1 101", 0) == 0; }
  /// `declared`: the length that the frame claims to have.
  static std::string frame(int kind, const std::string& payload, bool last = true,
                           std::optional<std::uint64_t> declared = std::nullopt) {
    const std::uint64_t length = declared.value_or(payload.size());
    std::string bytes(1, static_cast<char>((last ? 0x80 : 0) | kind));
    const int words = length < 126 ? 0 : length < 65536 ? 2 : 8;
    bytes += static_cast<char>(0x80 | (words == 0 ? length : words == 2 ? 126U : 127U));
    for (int i = words - 1; i >= 0; --i) bytes += static_cast<char>(length >> (8 * i));
    const std::string mask = "\x12\x34\x56\x78";
    bytes += mask;
    for (std::size_t i = 0; i < payload.size(); ++i) bytes += static_cast<char>(payload[i] ^ mask[i % 4]);
    return bytes;
  }
  bool say(const std::string& text) { return send(frame(1, text)); }
  /// The next frame; nothing where the connection ends.
  std::optional<Frame> hear() {
    if (!fill(2)) return std::nullopt;
    const auto byte = [this](std::size_t i) { return static_cast<unsigned char>(received_[i]); };
    std::uint64_t length = byte(1) & 0x7fU;
    const std::size_t words = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (!fill(2 + words)) return std::nullopt;
    if (words > 0) length = 0;
    for (std::size_t i = 0; i < words; ++i) length = length << 8U | byte(2 + i);
    if (!fill(2 + words + length)) return std::nullopt;
    Frame frame{byte(0) & 0x0f, {}};
    frame.payload = take(2 + words + length).substr(2 + words);
    return frame;
  }
  /// The next message; empty where the connection ends before.
  std::string hear_text() {
    while (const std::optional<Frame> frame = hear())
      if (frame->kind == 1 || frame->kind == 2) return frame->payload;
    return "";
  }

 private:
  bool read_some() {
    pollfd wanted{descriptor_, POLLIN, 0};
    if (::poll(&wanted, 1, kPatience_ms) <= 0) return false;
    char bytes[16384];
    const ssize_t n = ::recv(descriptor_, bytes, sizeof bytes, 0);
    if (n <= 0) {
      ended_ = true;
      return false;
    }
    received_.append(bytes, static_cast<std::size_t>(n));
    return true;
  }
  std::string take(std::size_t count) {
    std::string taken = received_.substr(0, count);
    received_.erase(0, count);
    return taken;
  }

  int descriptor_;
  std::string received_;
  bool ended_ = false;
};

}  // namespace lodestone::tests
