#include "serial_session.h"

#include <random>
#include <string>
#include <utility>

#include "serial_limits.h"

namespace lodestone::rig {

SerialSession::SerialSession(const SerialConfig& config, const physics::CoilsDescription& coils,
                             SerialLink::OpenPort open)
    : config_(config), coils_(coils), link_(std::move(open), config.reply_timeout_s, config.tries) {
  ensure_connected();
}

void SerialSession::ensure_connected() {
  if (link_.is_open()) return;
  try {
    link_.open();
    ++connections_;
    say_hello();
    const wire::CoilLimits limits = wire_limits(config_, coils_);
    SerialLink::Bytes body(wire::kCoilLimitsSize);
    wire::put_coil_limits(body.data(), &limits);
    link_.exchange(wire::kConfigure, body);
    wait_until_ready();
  } catch (...) {
    link_.close();
    throw;
  }
}

void SerialSession::say_hello() {
  const wire::HelloRequest hello{wire::kProtocolVersion, std::random_device()()};
  SerialLink::Bytes body(wire::kHelloRequestSize);
  wire::put_hello_request(body.data(), &hello);
  SerialLink::Bytes reply;
  // Opening the port resets many Arduinos, whose bootloader then listens for about a second.
  for (int round = 0;; ++round) {
    try {
      reply = link_.exchange(wire::kHello, body);
      break;
    } catch (const LinkLost&) {
      if (round * link_.timeout_s() > config_.setup_timeout_s) throw;
    }
  }
  if (reply.size() != wire::kHelloReplySize)
    throw common::HardwareError("what answers on the serial port is not the coil controller");
  wire::HelloReply answer{};
  wire::get_hello_reply(reply.data(), &answer);
  info_.protocol = answer.version;
  info_.firmware = std::to_string(answer.firmware[0]) + "." + std::to_string(answer.firmware[1]) + "." +
                   std::to_string(answer.firmware[2]);
  info_.reset_cause = answer.reset_cause;
}

void SerialSession::wait_until_ready() {
  constexpr double kLook_s = 0.02;
  for (double waited_s = 0.0; waited_s < config_.setup_timeout_s; waited_s += kLook_s) {
    if (coil_state(link_.exchange(wire::kStatus)).state & wire::kStateReady) return;
    link_.wait(kLook_s);
  }
  throw common::HardwareError(
      "the motor controllers do not answer the coil controller: is their supply on, are "
      "their addresses 0x80 and 0x81 and their mode packet serial at 115200 baud?");
}

SerialLink::Bytes SerialSession::request(wire::MessageType type, const SerialLink::Bytes& body) {
  const std::int64_t stops_before = stops_;
  std::unique_lock<std::mutex> lock(mutex_);
  if (type == wire::kPulse && stops_ != stops_before) throw_pulse_given_up();
  stop_done_.wait(lock, [this] { return !link_.stop_requested(); });  // a mutex alone lets anyone pass
  ensure_connected();
  try {
    return link_.exchange(type, body);
  } catch (const LinkLost&) {
    link_.close();
    throw;
  }
}

void SerialSession::stop() {
  ++stops_;
  struct LetOthersOn {
    std::condition_variable& done;
    ~LetOthersOn() { done.notify_all(); }
  } let_others_on{stop_done_};
  std::unique_lock<std::mutex> lock(mutex_, std::defer_lock);
  const SerialLink::StopRequest request(link_);  // ends before the lock does, or a waiter could miss it
  lock.lock();
  if (link_.is_open()) link_.exchange(wire::kStop);  // else the firmware's own limits end the pulse
}

CoilControllerInfo SerialSession::info() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return info_;
}

}  // namespace lodestone::rig
