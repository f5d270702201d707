#pragma once
// A web server with a small page, whose WebSockets say back what they hear.
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "console/raw_client.h"
#include "lodestone/console/web_server.h"

namespace lodestone::tests {

class RunningServer {
 public:
  explicit RunningServer(console::WebServerConfig config = {}, console::Pages pages = small_page(),
                         console::Access access = {false, ""}) {
    console::WebServerHandlers handlers;
    handlers.pages = std::move(pages);
    handlers.opened = [this](console::ClientId id) { note([&] { opened_.push_back(id); }); };
    handlers.closed = [this](console::ClientId id) { note([&] { closed_.push_back(id); }); };
    handlers.text = [this](console::ClientId id, const std::string& text) {
      if (text == "throw") throw std::runtime_error("it does not like this");
      note([&] { heard_.push_back(text); });
      server_ready();
      server_->send(id, "heard " + text);
    };
    handlers.farewell = [](const std::string& why) { return "bye: " + why; };
    const std::lock_guard<std::mutex> lock(mutex_);
    server_ = std::make_unique<console::WebServer>(config, std::move(access), std::move(handlers));
  }
  ~RunningServer() { end(); }

  static console::Pages small_page() {
    return [](const console::RequestHead& head) {
      if (head.target == "/throw") throw std::runtime_error("a page that fails");
      if (head.target != "/") return console::told(404, "there is none");
      console::Response page;
      page.content_type = "text/html; charset=utf-8";
      page.body = "<p>console</p>";
      return page;
    };
  }

  console::WebServer& operator*() { return *server_; }
  console::WebServer* operator->() { return server_.get(); }
  unsigned short port() const { return server_->port(); }
  void end() { server_.reset(); }

  /// Waits until the server tells; whether it did.
  bool opened(std::size_t count) {
    return wait([&] { return opened_.size() >= count; });
  }
  bool closed(std::size_t count) {
    return wait([&] { return closed_.size() >= count; });
  }
  std::size_t closed_so_far() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return closed_.size();
  }
  console::ClientId last_opened() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return opened_.back();
  }
  std::size_t heard_so_far() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return heard_.size();
  }
  bool answers() { return RawClient(port()).ask(RawClient::get("/")).rfind("HTTP/1.1 200", 0) == 0; }

 private:
  template <class Change>
  void note(const Change& change) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      change();
    }
    changed_.notify_all();
  }
  template <class Condition>
  bool wait(const Condition& condition) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::milliseconds(kPatience_ms), condition);
  }
  void server_ready() { const std::lock_guard<std::mutex> lock(mutex_); }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<console::ClientId> opened_;
  std::vector<console::ClientId> closed_;
  std::vector<std::string> heard_;
  std::unique_ptr<console::WebServer> server_;
};

}  // namespace lodestone::tests
