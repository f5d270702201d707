#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lodestone/console/access.h"
#include "lodestone/console/answer.h"

namespace lodestone::console {

/// One WebSocket; never given twice.
using ClientId = std::int64_t;

/// Where a web server listens, and how much of it anybody may take.
struct WebServerConfig {
  std::string address = "127.0.0.1";     ///< an IP address
  unsigned short port = 0;               ///< 0: any that is free
  std::size_t max_clients = 32;          ///< WebSockets
  std::size_t max_connections = 64;      ///< others; one more, and the one that has waited longest is closed
  std::size_t max_silent = 8;            ///< of those, that have not asked for anything yet
  std::size_t max_header_bytes = 16384;  ///< of a request
  std::size_t max_message_bytes = 65536;
  double max_messages_per_s = 100.0;  ///< of one client, on average; pings count
  double message_burst = 200.0;
  std::size_t max_queued = 64;  ///< messages to a client that does not read, and
  std::size_t max_queued_bytes = std::size_t{4}
                                 << 20U;  ///< their size together; beyond it the client is closed
  double request_timeout_s = 10.0;        ///< for a request to come, in whole
  double stall_timeout_s = 30.0;          ///< for a piece of a file to be taken
  double client_timeout_s = 20.0;         ///< without a word, not even the answer to a ping
  double write_timeout_s = 10.0;          ///< for a message to be taken
  double farewell_timeout_s = 2.0;        ///< for a client that is told to go
};

/// What a web server tells. `pages` is called in a thread of its own, so that a slow disk delays no message;
/// all others in the thread of the WebSockets, one at a time, and they may not wait. They may be called
/// before the constructor of the server has returned. None may throw: a client whose `text` throws is closed.
struct WebServerHandlers {
  Pages pages;
  std::function<void(ClientId)> opened;
  std::function<void(ClientId, const std::string&)> text;
  std::function<void(ClientId)> closed;  ///< once for every one that was opened
  /// The last message to a client that the server closes, from the reason in words.
  std::function<std::string(const std::string&)> farewell;
};

/// Serves pages and WebSockets. Pages are one thread's work; WebSockets another's, which goes before ordinary
/// threads (common::RealtimeThread), as heartbeats come through it. A client that reads nothing makes nobody
/// wait: what is sent to it is kept up to a bound, then it is closed.
class WebServer {
 public:
  /// Listens from now on. Throws ConfigError where the address is none, IoError where it cannot be listened
  /// at.
  WebServer(const WebServerConfig& config, Access access, WebServerHandlers handlers);
  /// Says goodbye to all clients, and waits at most 0.3 s for them.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  unsigned short port() const;

  /// Any thread may send; nothing happens where the client is gone. Messages arrive in the order in which one
  /// thread sends them.
  void send(ClientId client, std::string text);
  void send(ClientId client, std::shared_ptr<const std::string> binary);
  /// Sends a last message, unless it is empty, and closes.
  void close(ClientId client, std::string last_text);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone::console
