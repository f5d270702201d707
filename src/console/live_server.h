#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "lodestone/console/web_server.h"
#include "upgrade.h"

namespace lodestone::console {

class LiveClient;

/// The WebSockets of a web server, in one thread that goes before ordinary ones. Its public calls may come
/// from any thread.
class LiveServer {
 public:
  LiveServer(const WebServerConfig& config, const WebServerHandlers& handlers);
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// Keeps a place for one more client; whether there is one. adopt() takes it.
  bool reserve();
  void adopt(Upgrade upgrade);
  void send(ClientId client, std::shared_ptr<const std::string> message, bool binary);
  void close(ClientId client, std::string last_text);

 private:
  friend class LiveClient;

  void run();
  void tick();
  void begin_to_stop();
  void forget(ClientId client, bool was_opened);
  /// Copied, as what is done with them removes some.
  std::map<ClientId, std::shared_ptr<LiveClient>> clients() const { return clients_; }

  const WebServerConfig config_;
  const WebServerHandlers& handlers_;
  boost::asio::io_context io_;
  boost::asio::steady_timer ticks_;
  std::map<ClientId, std::shared_ptr<LiveClient>> clients_;  // by the thread alone, as what follows
  ClientId last_ = 0;
  bool stopping_ = false;
  std::atomic<std::size_t> places_taken_{0};
  std::thread thread_;
};

}  // namespace lodestone::console
