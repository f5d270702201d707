#include "live_client.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>
#include <exception>

#include "live_server.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/log.h"
#include "lodestone/common/shown.h"

namespace lodestone::console {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

double live_now_s() { return common::SteadyClock().now_s(); }

std::chrono::steady_clock::duration live_seconds(double value) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(value));
}

}  // namespace

LiveClient::LiveClient(ClientId id, Upgrade upgrade, LiveServer& server)
    : id_(id),
      server_(server),
      stream_(std::move(upgrade.socket)),
      request_(std::move(upgrade.request)),
      rate_(server.config_.max_messages_per_s, server.config_.message_burst) {}

void LiveClient::start() {
  websocket::stream_base::timeout limits{};
  limits.handshake_timeout = live_seconds(server_.config_.request_timeout_s);
  limits.idle_timeout = live_seconds(server_.config_.client_timeout_s);
  limits.keep_alive_pings = true;
  stream_.set_option(limits);
  stream_.auto_fragment(false);  // an image goes out in one piece
  stream_.read_message_max(0);   // read() counts, so that there is a word before the end
  stream_.control_callback([this](websocket::frame_type, beast::string_view) {
    if (closing_ || rate_.take(live_now_s())) return;
    boost::asio::post(stream_.get_executor(), [self = shared_from_this()] { self->drop(); });
  });
  stream_.async_accept(request_, [self = shared_from_this()](Error failed) {
    if (failed || self->gone_) return self->drop();
    self->opened_ = true;
    if (self->server_.handlers_.opened) self->server_.handlers_.opened(self->id_);
    if (self->closing_) return self->finish();
    self->read();
    if (!self->queue_.empty()) self->write();
  });
}

void LiveClient::read() {
  const std::size_t room = server_.config_.max_message_bytes + 1 - incoming_.size();
  stream_.async_read_some(incoming_, room, [self = shared_from_this()](Error failed, std::size_t) {
    if (failed) return self->drop();
    self->on_read();
  });
}

void LiveClient::on_read() {
  const WebServerConfig& config = server_.config_;
  if (closing_ || gone_) return;
  if (incoming_.size() > config.max_message_bytes)
    return dismiss("a message of more than " + std::to_string(config.max_message_bytes) + " bytes");
  if (!stream_.is_message_done()) return read();
  if (!stream_.got_text()) return dismiss("a message that is not text");
  if (!rate_.take(live_now_s()))
    return dismiss("more than " + std::to_string(static_cast<int>(config.max_messages_per_s)) +
                   " messages a second");
  const std::string text = beast::buffers_to_string(incoming_.data());
  incoming_.consume(incoming_.size());
  try {
    server_.handlers_.text(id_, text);
  } catch (const std::exception& error) {  // one message ends no server
    common::log_warning("console: a message could not be heard: " + common::shown(error.what()));
    return dismiss(error.what());
  }
  if (!closing_ && !gone_) read();
}

void LiveClient::send(std::shared_ptr<const std::string> message, bool binary) {
  if (closing_ || gone_) return;
  queued_bytes_ += message->size();
  queue_.push_back({std::move(message), binary});
  const WebServerConfig& config = server_.config_;
  if (queue_.size() > config.max_queued || (queue_.size() > 1 && queued_bytes_ > config.max_queued_bytes))
    return drop();
  if (opened_ && !writing_) write();
}

void LiveClient::dismiss(const std::string& why) {
  const auto& farewell = server_.handlers_.farewell;
  close(farewell ? farewell(why) : "", websocket::close_code::policy_error);
}

void LiveClient::close(std::string last_text, websocket::close_code code) {
  if (closing_ || gone_) return;
  closing_ = true;
  closing_began_s_ = live_now_s();
  close_code_ = code;
  if (!last_text.empty())
    queue_.push_back({std::make_shared<const std::string>(std::move(last_text)), false});
  if (opened_ && !writing_) finish();
}

void LiveClient::write() {
  writing_ = true;
  write_began_s_ = live_now_s();
  const Outgoing& next = queue_.front();
  stream_.binary(next.binary);
  stream_.async_write(boost::asio::buffer(*next.message),
                      [self = shared_from_this()](Error failed, std::size_t) { self->on_written(failed); });
}

void LiveClient::on_written(Error failed) {
  writing_ = false;
  if (failed || gone_) return drop();
  queued_bytes_ -= std::min(queued_bytes_, queue_.front().message->size());
  queue_.pop_front();
  if (closing_) return finish();
  if (!queue_.empty()) write();
}

/// The rest of the queue, then the end.
void LiveClient::finish() {
  if (!queue_.empty()) return write();
  stream_.async_close(close_code_, [self = shared_from_this()](Error) { self->drop(); });
}

void LiveClient::drop() {
  if (gone_) return;
  gone_ = true;
  beast::get_lowest_layer(stream_).close();
  server_.forget(id_, opened_);
}

void LiveClient::check_timeouts() {
  const double now_s = live_now_s();
  if (opened_ && !closing_ && !stream_.is_open()) {  // the client has said goodbye, or something wrong
    closing_ = true;
    closing_began_s_ = now_s;
  }
  if ((writing_ && now_s - write_began_s_ > server_.config_.write_timeout_s) ||
      (closing_ && now_s - closing_began_s_ > server_.config_.farewell_timeout_s))
    drop();
}

}  // namespace lodestone::console
