#include "page_connection.h"

#include <algorithm>
#include <boost/asio/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <limits>

#include "page_server.h"

namespace lodestone::console {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

namespace {

constexpr std::size_t kPiece_bytes = 65536;
constexpr std::size_t kDrain_bytes = 65536;  // of what still comes after a refusal,
constexpr std::chrono::seconds kDrain{1};    // so long, so that the refusal is not lost

std::chrono::steady_clock::duration page_seconds(double value) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(value));
}

std::string text_of(beast::string_view text) { return {text.data(), text.size()}; }

/// Nothing where a header that decides is there twice.
template <class Request>
std::optional<RequestHead> head_of(const Request& request) {
  RequestHead head;
  const std::pair<const char*, std::string*> wanted[] = {
      {"Host", &head.host},
      {"Origin", &head.origin},
      {"Cookie", &head.cookie},
      {"Sec-Fetch-Site", &head.fetch_site},
      {"Sec-Fetch-Mode", &head.fetch_mode},
      {"Range", &head.range},
  };
  for (const auto& [name, value] : wanted) {
    if (request.count(name) > 1) return std::nullopt;
    *value = text_of(request[name]);
  }
  if (request.count(http::field::origin) == 1 && head.origin.empty()) return std::nullopt;
  head.method = text_of(request.method_string());
  head.target = text_of(request.target());
  head.upgrade = beast::websocket::is_upgrade(request);
  return head;
}

}  // namespace

PageConnection::PageConnection(asio::ip::tcp::socket socket, PageServer& server)
    : server_(server), stream_(std::move(socket)), incoming_(server.config_.max_header_bytes + 1) {}

void PageConnection::read() {
  waiting_ = true;
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(server_.config_.max_header_bytes));
  parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // none is read
  stream_.expires_after(page_seconds(server_.config_.request_timeout_s));
  http::async_read_header(stream_, incoming_, *parser_,
                          [self = shared_from_this()](Error failed, std::size_t) { self->on_head(failed); });
}

void PageConnection::on_head(Error failed) {
  if (gone_) return;
  waiting_ = false;
  if (failed == http::error::header_limit || failed == http::error::buffer_overflow) {
    has_asked_ = true;
    return reply(told(431, "the headers are too long"), false);
  }
  if (failed == http::error::end_of_stream || failed == http::error::partial_message) return drop();
  const bool has_body = !failed && !parser_->is_done();
  const bool is_malformed = failed && failed.category() == Error(http::error::bad_value).category();
  if (failed && !is_malformed) return drop();
  has_asked_ = true;
  const std::optional<RequestHead> head = is_malformed ? std::nullopt : head_of(parser_->get());
  if (!head) return reply(told(400, "this is no request"), false);
  head_only_ = head->method == "HEAD";
  Response response = answer(server_.access_, server_.pages_, *head);
  if (response.status < 400 && has_body) return reply(told(413, "a request has no body here"), false);
  if (response.status == 101) return hand_on();
  const bool keep = parser_->get().keep_alive() && !has_body && response.status != 400;
  reply(std::move(response), keep);
}

/// To the WebSockets.
void PageConnection::hand_on() {
  if (incoming_.size() > 0) return reply(told(400, "a message before the answer to the handshake"), false);
  if (!server_.live_.reserve())
    return reply(told(503, "there are too many clients: close another page"), false);
  const auto self = shared_from_this();
  gone_ = true;
  stream_.expires_never();
  server_.live_.adopt({stream_.release_socket(), parser_->release()});
  server_.forget(self);
}

void PageConnection::reply(Response response, bool keep) {
  response_ = std::move(response);
  keep_ = keep;
  if (!response_.file) response_.length_bytes = response_.body.size();
  head_ = {};
  head_.version(11);
  head_.result(static_cast<unsigned>(response_.status));
  for (const Header& header : headers_of(response_)) head_.set(header.name, header.value);
  head_.content_length(response_.length_bytes);
  head_.keep_alive(keep);
  stream_.expires_after(page_seconds(server_.config_.stall_timeout_s));
  http::async_write(stream_, head_, [self = shared_from_this()](Error failed, std::size_t) {
    if (self->gone_) return;
    if (failed || self->head_only_ || self->response_.length_bytes == 0) return self->on_sent(failed);
    self->response_.file ? self->send_piece() : self->send_text();
  });
}

void PageConnection::send_text() {
  asio::async_write(stream_, asio::buffer(response_.body),
                    [self = shared_from_this()](Error failed, std::size_t) { self->on_sent(failed); });
}

void PageConnection::send_piece() {
  piece_.resize(std::min<std::uint64_t>(kPiece_bytes, response_.length_bytes));
  const std::size_t got = response_.file->read(response_.first_byte, piece_.data(), piece_.size());
  if (got == 0) return drop();  // it has become shorter: an answer that breaks off is not taken for whole
  response_.first_byte += got;
  response_.length_bytes -= got;
  stream_.expires_after(page_seconds(server_.config_.stall_timeout_s));
  asio::async_write(stream_, asio::buffer(piece_.data(), got),
                    [self = shared_from_this()](Error failed, std::size_t) {
                      if (self->gone_) return;
                      if (failed || self->response_.length_bytes == 0) return self->on_sent(failed);
                      self->send_piece();
                    });
}

void PageConnection::on_sent(Error failed) {
  if (gone_) return;
  if (failed) return drop();
  response_ = {};
  head_only_ = false;
  keep_ ? read() : finish();
}

void PageConnection::finish() {
  Error failed;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, failed);
  if (failed) return drop();
  stream_.expires_after(kDrain);
  piece_.resize(kPiece_bytes);
  drain(kDrain_bytes);
}

void PageConnection::drain(std::size_t left) {
  stream_.async_read_some(asio::buffer(piece_),
                          [self = shared_from_this(), left](Error failed, std::size_t got) {
                            if (failed || got >= left) return self->drop();
                            self->drain(left - got);
                          });
}

void PageConnection::drop() {
  if (gone_) return;
  gone_ = true;
  stream_.close();
  server_.forget(shared_from_this());
}

}  // namespace lodestone::console
