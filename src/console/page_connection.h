#pragma once

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "lodestone/console/request_head.h"
#include "lodestone/console/response.h"

namespace lodestone::console {

class PageServer;

/// One connection to the pages: request after request. All calls come from the server's thread.
class PageConnection : public std::enable_shared_from_this<PageConnection> {
 public:
  PageConnection(boost::asio::ip::tcp::socket socket, PageServer& server);

  void start() { read(); }
  /// Closes at once.
  void drop();
  /// Has not asked for anything yet.
  bool is_silent() const { return !has_asked_; }
  /// Has no answer under way.
  bool is_waiting() const { return waiting_; }

 private:
  using Error = boost::beast::error_code;
  using Empty = boost::beast::http::empty_body;

  void read();
  void on_head(Error failed);
  void hand_on();
  void reply(Response response, bool keep);
  void send_text();
  void send_piece();
  void on_sent(Error failed);
  void finish();
  void drain(std::size_t left);

  PageServer& server_;
  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer incoming_;
  std::optional<boost::beast::http::request_parser<Empty>> parser_;
  boost::beast::http::response<Empty> head_;
  Response response_;  // what is left to be sent of it
  std::vector<char> piece_;
  bool has_asked_ = false;
  bool waiting_ = true;
  bool gone_ = false;
  bool keep_ = false;
  bool head_only_ = false;
};

}  // namespace lodestone::console
