#include "lodestone/console/web_server.h"

#include <utility>

#include "live_server.h"
#include "page_server.h"

namespace lodestone::console {

class WebServer::Impl {
 public:
  Impl(const WebServerConfig& config, Access access, WebServerHandlers handlers)
      : handlers_(std::move(handlers)),
        live_(config, handlers_),
        pages_(config, std::move(access), handlers_.pages, live_) {}

  const WebServerHandlers handlers_;
  LiveServer live_;
  PageServer pages_;  // gone before what it hands its connections to
};

WebServer::WebServer(const WebServerConfig& config, Access access, WebServerHandlers handlers)
    : impl_(std::make_unique<Impl>(config, std::move(access), std::move(handlers))) {}

WebServer::~WebServer() = default;

unsigned short WebServer::port() const { return impl_->pages_.port(); }

void WebServer::send(ClientId client, std::string text) {
  impl_->live_.send(client, std::make_shared<const std::string>(std::move(text)), false);
}

void WebServer::send(ClientId client, std::shared_ptr<const std::string> binary) {
  impl_->live_.send(client, std::move(binary), true);
}

void WebServer::close(ClientId client, std::string last_text) {
  impl_->live_.close(client, std::move(last_text));
}

}  // namespace lodestone::console
