#pragma once

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace lodestone::console {

/// A connection that asks for a WebSocket, and may have it.
struct Upgrade {
  boost::asio::ip::tcp::socket socket;
  boost::beast::http::request<boost::beast::http::empty_body> request;
};

}  // namespace lodestone::console
