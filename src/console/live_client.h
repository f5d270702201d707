#pragma once

#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <string>

#include "lodestone/console/rate_limit.h"
#include "lodestone/console/web_server.h"
#include "upgrade.h"

namespace lodestone::console {

class LiveServer;

/// One WebSocket. All calls come from the server's thread.
class LiveClient : public std::enable_shared_from_this<LiveClient> {
 public:
  LiveClient(ClientId id, Upgrade upgrade, LiveServer& server);

  void start();
  void send(std::shared_ptr<const std::string> message, bool binary);
  /// Says farewell in words of the server's handler.
  void dismiss(const std::string& why);
  /// Sends what waits, then a last message unless it is empty, and closes.
  void close(std::string last_text, boost::beast::websocket::close_code code);
  /// Closes at once.
  void drop();
  /// Closes where something takes too long.
  void check_timeouts();

 private:
  using Error = boost::beast::error_code;

  struct Outgoing {
    std::shared_ptr<const std::string> message;
    bool binary;
  };

  void read();
  void on_read();
  void write();
  void on_written(Error failed);
  void finish();

  const ClientId id_;
  LiveServer& server_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
  boost::beast::http::request<boost::beast::http::empty_body> request_;
  boost::beast::flat_buffer incoming_;
  RateLimit rate_;
  std::deque<Outgoing> queue_;  // the first is being written
  std::size_t queued_bytes_ = 0;
  bool opened_ = false;
  bool writing_ = false;
  bool closing_ = false;
  bool gone_ = false;
  double write_began_s_ = 0.0;
  double closing_began_s_ = 0.0;
  boost::beast::websocket::close_code close_code_ = boost::beast::websocket::close_code::normal;
};

}  // namespace lodestone::console
