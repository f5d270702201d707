#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <list>
#include <memory>
#include <thread>

#include "live_server.h"
#include "lodestone/console/web_server.h"

namespace lodestone::console {

class PageConnection;

/// The requests for pages to a web server, in an ordinary thread; what asks for a WebSocket and may have it
/// is handed on. However many connections are opened and left, the next one is taken: the one that has waited
/// longest makes room.
class PageServer {
 public:
  /// As WebServer's constructor.
  PageServer(const WebServerConfig& config, Access access, const Pages& pages, LiveServer& live);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  unsigned short port() const { return acceptor_.local_endpoint().port(); }

 private:
  friend class PageConnection;

  void listen();
  void accept();
  void take(boost::asio::ip::tcp::socket socket);
  void make_room();
  void forget(const std::shared_ptr<PageConnection>& connection) { connections_.remove(connection); }

  const WebServerConfig config_;
  const Access access_;
  const Pages& pages_;
  LiveServer& live_;
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer retry_;
  std::list<std::shared_ptr<PageConnection>> connections_;  // the oldest first; by the thread alone
  std::thread thread_;
};

}  // namespace lodestone::console
