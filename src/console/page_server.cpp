#include "page_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/thread_name.h"
#include "page_connection.h"

namespace lodestone::console {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;

namespace {

constexpr std::chrono::milliseconds kRetry{100};  // where the program has too many files open

tcp::endpoint endpoint_of(const WebServerConfig& config) {
  boost::system::error_code failed;
  const asio::ip::address address = asio::ip::make_address(config.address, failed);
  if (failed)
    throw common::ConfigError("console: " + common::shown(config.address) +
                              " is no IP address to listen at: give one of this machine with --listen");
  return {address, config.port};
}

}  // namespace

PageServer::PageServer(const WebServerConfig& config, Access access, const Pages& pages, LiveServer& live)
    : config_(config),
      access_(std::move(access)),
      pages_(pages),
      live_(live),
      io_(1),
      acceptor_(io_),
      retry_(io_) {
  listen();
  accept();
  thread_ = std::thread([this] {
    common::name_thread("web-pages");
    io_.run();
  });
}

PageServer::~PageServer() {
  io_.stop();
  thread_.join();
}

void PageServer::listen() {
  const tcp::endpoint endpoint = endpoint_of(config_);
  boost::system::error_code failed;
  acceptor_.open(endpoint.protocol(), failed);
  if (!failed) acceptor_.set_option(tcp::acceptor::reuse_address(true), failed);
  if (!failed) acceptor_.bind(endpoint, failed);
  if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
  if (!failed) return;
  const bool taken = failed == asio::error::address_in_use;
  throw common::IoError(fmt::format("console: cannot listen at {} port {}: {}; {}", config_.address,
                                    config_.port, failed.message(),
                                    taken ? "is another console running? Give another port with --port"
                                          : "give an address of this machine with --listen, and a port "
                                            "above 1023 with --port"));
}

void PageServer::accept() {
  acceptor_.async_accept([this](boost::system::error_code failed, tcp::socket socket) {
    if (!failed) {
      take(std::move(socket));
      return accept();
    }
    retry_.expires_after(kRetry);
    retry_.async_wait([this](boost::system::error_code) { accept(); });
  });
}

void PageServer::take(tcp::socket socket) {
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  connections_.push_back(std::make_shared<PageConnection>(std::move(socket), *this));
  connections_.back()->start();
  make_room();
}

void PageServer::make_room() {
  const auto is_silent = [](const auto& connection) { return connection->is_silent(); };
  const auto first = std::find_if(connections_.begin(), connections_.end(), is_silent);
  const auto silent = std::count_if(connections_.begin(), connections_.end(), is_silent);
  if (static_cast<std::size_t>(silent) > config_.max_silent) return std::shared_ptr(*first)->drop();
  if (connections_.size() <= config_.max_connections) return;
  const auto waiting = std::find_if(connections_.begin(), connections_.end(),
                                    [](const auto& connection) { return connection->is_waiting(); });
  // The newest waits too, but makes no room for itself.
  const bool found = waiting != connections_.end() && *waiting != connections_.back();
  std::shared_ptr(found ? *waiting : connections_.front())->drop();
}

}  // namespace lodestone::console
