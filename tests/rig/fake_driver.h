#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "descriptor_port.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/json.h"
#include "lodestone/rig/driver_link.h"

namespace lodestone::tests {

/// A driver of ideal coils in a thread, as docs/driver-protocol.md has it, and its faults. Each open() is a
/// new stream to the same driver.
class FakeDriver {
 public:
  using Json = common::Json;

  ~FakeDriver() {
    for (const int end : ends_) shutdown(end, SHUT_RDWR);
    for (std::thread& thread : threads_) thread.join();
    for (const int end : ends_) close(end);
  }

  rig::DriverLink::OpenStream open() {
    return [this] {
      int ends[2];
      if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) std::abort();
      ends_.push_back(ends[1]);
      threads_.emplace_back([this, end = ends[1]] { serve(end); });
      return std::make_unique<rig::DescriptorPort>(ends[0], "driver", "has it ended?");
    };
  }

  bool on() {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_when_due();
    return flows();
  }
  int pulses() const { return pulses_; }

  // Faults.
  std::atomic<bool> hangs{false};      ///< answers nothing any more
  std::atomic<bool> dies{false};       ///< at the next request
  std::atomic<bool> babbles{false};    ///< prints to the stream
  std::atomic<bool> takes_all{false};  ///< refuses nothing
  std::atomic<bool> keeps_on{false};   ///< silence and a lost line mean nothing to it
  std::atomic<int> protocol{rig::kDriverProtocol};
  using Says = std::function<double(std::size_t coil, double current_A)>;
  /// What it says instead of the current.
  void say(Says says) {
    const std::lock_guard<std::mutex> lock(mutex_);
    says_ = std::move(says);
  }
  std::function<rig::DriverReply(const Json& request)> other;  ///< answers what is not for coils

 private:
  static double now_s() { return common::SteadyClock().now_s(); }

  /// False once the stream has ended.
  static bool read_all(int end, char* bytes, std::size_t count) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t got = ::read(end, bytes + done, count - done);
      if (got == 0 || (got < 0 && errno != EAGAIN)) return false;
      if (got < 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      else
        done += static_cast<std::size_t>(got);
    }
    return true;
  }
  static void write_all(int end, const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t sent = send(end, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (sent < 0 && errno != EAGAIN) return;
      if (sent > 0) done += static_cast<std::size_t>(sent);
    }
  }

  static void write_frame(int end, const Json& content, const std::vector<std::uint8_t>& bytes) {
    const std::string said = content.dump();
    std::string frame;
    for (int i = 0; i < 4; ++i) frame.push_back(static_cast<char>(said.size() >> (8 * i) & 0xff));
    write_all(end, frame + said + std::string(bytes.begin(), bytes.end()));
  }

  void serve(int end) {
    unsigned char head[4];
    while (read_all(end, reinterpret_cast<char*>(head), 4)) {
      std::string text(head[0] | head[1] << 8 | head[2] << 16, '\0');
      if (!read_all(end, text.data(), text.size())) break;
      const Json request = Json::parse(text);
      if (dies) {
        shutdown(end, SHUT_RDWR);
        break;
      }
      if (hangs) continue;
      if (babbles) write_all(end, "Traceback (most recent call last)");
      rig::DriverReply reply = answer(request, end);
      if (!reply.content.is_object()) {
        write_frame(end, reply.content, {});
        continue;
      }
      reply.content["id"] = request["id"];
      write_frame(end, reply.content, reply.bytes);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!keeps_on && owner_ == end) current_A_.assign(current_A_.size(), 0.0);
  }

  bool flows() const {
    for (const double one_A : current_A_)
      if (one_A != 0.0) return true;
    return false;
  }
  void end_when_due() {
    const bool silent = flows() && now_s() > heard_s_ + 0.5 && !keeps_on;
    if (silent) fault_ = "nothing heard for 0.5 s";
    if (silent || now_s() >= end_s_) current_A_.assign(current_A_.size(), 0.0);
  }

  rig::DriverReply answer(const Json& request, int end) {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_when_due();
    heard_s_ = now_s();
    const std::string asked = request["do"];
    if (asked == "hello") {
      if (request["role"] == "coils") {
        owner_ = end;
        limits_ = request;
        if (!keeps_on || current_A_.empty()) current_A_.assign(request["coils"].size(), 0.0);
      }
      return {{{"protocol", protocol.load()}, {"name", "fake"}}, {}};
    }
    if (other) return other(request);
    if (asked == "pulse") return {pulse(request), {}};
    if (asked == "stop") current_A_.assign(current_A_.size(), 0.0);
    if (asked == "clear") fault_.clear();
    if (asked == "status") return {status(), {}};
    if (asked == "stop" || asked == "clear" || asked == "ping" || takes_all) return {Json::object(), {}};
    return {{{"error", "unknown request"}}, {}};
  }
  Json status() const {
    Json current_A = Json::array();
    for (std::size_t coil = 0; coil < current_A_.size(); ++coil)
      current_A.push_back(says_ ? says_(coil, current_A_[coil]) : current_A_[coil]);
    Json faults = Json::array();
    if (!fault_.empty()) faults.push_back(fault_);
    return {{"current_A", current_A}, {"supply_V", 24.0}, {"faults", faults}};
  }
  Json pulse(const Json& request) {
    const std::string no = takes_all ? "" : refusal(request);
    if (!no.empty()) return {{"error", no}};
    ++pulses_;
    for (std::size_t coil = 0; coil < current_A_.size(); ++coil)
      current_A_[coil] = request["current_A"][coil].get<double>();
    end_s_ = now_s() + request["duration_s"].get<double>();
    return Json::object();
  }
  std::string refusal(const Json& request) const {
    if (!fault_.empty()) return fault_;
    if (request["duration_s"] > limits_["max_pulse_s"]) return "too long";
    for (std::size_t coil = 0; coil < current_A_.size(); ++coil) {
      const Json& limit = limits_["coils"][coil];
      const Json& asked_A = request["current_A"][coil];
      if (asked_A > limit["largest_A"] || asked_A < limit["smallest_A"]) return "too much";
      for (std::size_t partner = 0; partner < current_A_.size(); ++partner)
        for (const Json& name : limit["not_with"])
          if (name == limits_["coils"][partner]["name"] && asked_A != 0.0 &&
              request["current_A"][partner] != 0.0)
            return "not together";
    }
    return "";
  }

  std::mutex mutex_;
  Says says_;
  int owner_ = -1;  ///< the stream that said hello last
  Json limits_;
  std::vector<double> current_A_;
  std::string fault_;
  double end_s_ = 0.0;
  double heard_s_ = 0.0;
  std::atomic<int> pulses_{0};
  std::vector<int> ends_;
  std::vector<std::thread> threads_;
};

}  // namespace lodestone::tests
