#include "lodestone/console/page_client.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>

#include "lodestone/common/error.h"

namespace lodestone::console {

struct PageClient::State {
  boost::asio::io_context io;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket{io};
  boost::beast::flat_buffer buffer;
  boost::system::error_code error;
  bool reading = false;
  bool read = false;

  [[noreturn]] static void fail(const boost::system::error_code& error) {
    throw common::IoError("the console: " + error.message());
  }
};

PageClient::PageClient(std::uint16_t port) : state_(std::make_unique<State>()) {
  State& state = *state_;
  const boost::asio::ip::tcp::endpoint there(boost::asio::ip::address_v4::loopback(), port);
  boost::system::error_code error;
  boost::beast::get_lowest_layer(state.socket).socket().connect(there, error);
  if (!error) state.socket.handshake("127.0.0.1:" + std::to_string(port), "/ws", error);
  if (error) State::fail(error);
  state.socket.read_message_max(64U << 20U);
}

PageClient::~PageClient() = default;

void PageClient::say(const common::Json& message) {
  boost::system::error_code error;
  state_->socket.text(true);
  state_->socket.write(boost::asio::buffer(message.dump()), error);
  if (error) State::fail(error);
}

std::optional<PageClient::Received> PageClient::hear(double timeout_s) {
  State& state = *state_;
  if (!state.reading) {
    state.reading = true;
    state.read = false;
    state.socket.async_read(state.buffer, [&state](const boost::system::error_code& error, std::size_t) {
      state.error = error;
      state.read = true;
    });
  }
  state.io.restart();
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                            std::chrono::duration<double>(timeout_s));
  while (!state.read && std::chrono::steady_clock::now() < until) state.io.run_one_until(until);
  if (!state.read) return std::nullopt;
  state.reading = false;
  if (state.error) State::fail(state.error);
  Received received{state.socket.got_binary(), boost::beast::buffers_to_string(state.buffer.data())};
  state.buffer.consume(state.buffer.size());
  return received;
}

}  // namespace lodestone::console
