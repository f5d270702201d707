#include "live_server.h"

#include <unistd.h>

#include <boost/asio/post.hpp>
#include <chrono>

#include "live_client.h"
#include "lodestone/common/realtime.h"
#include "lodestone/common/thread_name.h"

namespace lodestone::console {

namespace asio = boost::asio;

namespace {

constexpr std::chrono::milliseconds kTick{250};
constexpr std::chrono::milliseconds kFarewellsAtTheEnd{300};

}  // namespace

LiveServer::LiveServer(const WebServerConfig& config, const WebServerHandlers& handlers)
    : config_(config), handlers_(handlers), io_(1), ticks_(io_), thread_([this] { run(); }) {}

LiveServer::~LiveServer() {
  asio::post(io_, [this] { begin_to_stop(); });
  thread_.join();
}

void LiveServer::run() {
  common::name_thread("web");
  const common::RealtimeThread realtime;  // a heartbeat that is late stops the coils
  tick();
  io_.run();
}

void LiveServer::tick() {
  for (const auto& [id, client] : clients()) client->check_timeouts();
  ticks_.expires_after(kTick);
  ticks_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled && !stopping_) tick();
  });
}

void LiveServer::begin_to_stop() {
  stopping_ = true;
  for (const auto& [id, client] : clients())
    client->close("", boost::beast::websocket::close_code::going_away);
  if (clients_.empty()) return io_.stop();
  ticks_.expires_after(kFarewellsAtTheEnd);
  ticks_.async_wait([this](const boost::system::error_code&) {
    for (const auto& [id, client] : clients()) client->drop();
    io_.stop();
  });
}

bool LiveServer::reserve() {
  if (places_taken_.fetch_add(1) < config_.max_clients) return true;
  --places_taken_;
  return false;
}

void LiveServer::adopt(Upgrade upgrade) {
  // The socket changes over to this thread.
  boost::system::error_code failed;
  const auto protocol = upgrade.socket.local_endpoint(failed).protocol();
  asio::ip::tcp::socket socket(io_);
  const int descriptor = failed ? -1 : upgrade.socket.release(failed);
  if (!failed) {
    socket.assign(protocol, descriptor, failed);
    if (failed) ::close(descriptor);
  }
  if (failed) {
    --places_taken_;
    return;
  }
  asio::post(io_, [this, taken = Upgrade{std::move(socket), std::move(upgrade.request)}]() mutable {
    if (stopping_) return;
    const ClientId id = ++last_;
    const auto client = std::make_shared<LiveClient>(id, std::move(taken), *this);
    clients_.emplace(id, client);
    client->start();
  });
}

void LiveServer::send(ClientId client, std::shared_ptr<const std::string> message, bool binary) {
  asio::post(io_, [this, client, message = std::move(message), binary] {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    const auto kept = found->second;  // a client that is dropped is forgotten meanwhile
    kept->send(message, binary);
  });
}

void LiveServer::close(ClientId client, std::string last_text) {
  asio::post(io_, [this, client, last_text = std::move(last_text)] {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    const auto kept = found->second;
    kept->close(last_text, boost::beast::websocket::close_code::normal);
  });
}

void LiveServer::forget(ClientId client, bool was_opened) {
  clients_.erase(client);
  --places_taken_;
  if (was_opened && handlers_.closed) handlers_.closed(client);
  if (stopping_ && clients_.empty()) io_.stop();
}

}  // namespace lodestone::console
