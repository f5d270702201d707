#include "serial_session.h"

#include <random>
#include <string>
#include <utility>

#include "serial_limits.h"

namespace lodestone::rig {

namespace {

std::string outputs_of(int controllers) {
  return std::to_string(controllers) + " motor controller" + (controllers == 1 ? "" : "s") + " (" +
         std::to_string(2 * controllers) + " outputs)";
}

std::string addresses_of(int controllers) {
  const std::string last = "0x8" + std::to_string(controllers - 1);
  return controllers == 1 ? last : "0x80" + std::string(controllers == 2 ? " and " : " to ") + last;
}

}  // namespace

SerialSession::SerialSession(const SerialConfig& config, const physics::CoilsDescription& coils,
                             SerialLink::OpenPort open)
    : config_(config),
      coils_(coils),
      controllers_(static_cast<std::uint8_t>(config.controllers_for(coils.count()))),
      link_(std::move(open), config.reply_timeout_s, config.tries) {
  ensure_connected();
}

void SerialSession::ensure_connected() {
  if (link_.is_open()) return;
  try {
    link_.open();
    ++connections_;
    say_hello();
    hand_over_limits();
    wait_until_ready();
  } catch (...) {
    link_.close();
    throw;
  }
}

void SerialSession::hand_over_limits() {
  const wire::CoilLimits limits = wire_limits(config_, coils_);
  SerialLink::Bytes body(wire::coil_limits_size(controllers_));
  wire::put_coil_limits(body.data(), &limits, controllers_);
  link_.exchange(wire::kConfigure, body);
  if (!need_ranges(coils_)) return;
  const wire::CoilRanges ranges = wire_ranges(config_, coils_);
  body.resize(wire::coil_ranges_size(controllers_));
  wire::put_coil_ranges(body.data(), &ranges, controllers_);
  link_.exchange(wire::kRanges, body);
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
  info_.motor_controllers = answer.controllers;
  info_.reset_cause = answer.reset_cause;
  if (answer.controllers != controllers_)
    throw common::HardwareError("the coil controller's firmware is for " + outputs_of(answer.controllers) +
                                ", the rig's " + std::to_string(coils_.count()) +
                                " coils (rig.coils, rig.serial.output) need " + outputs_of(controllers_) +
                                ": flash coils-" + std::to_string(controllers_) +
                                ".hex (docs/drive-a-bench.md)");
}

void SerialSession::wait_until_ready() {
  constexpr double kLook_s = 0.02;
  for (double waited_s = 0.0; waited_s < config_.setup_timeout_s; waited_s += kLook_s) {
    if (coil_state(link_.exchange(wire::kStatus), controllers_).state & wire::kStateReady) return;
    link_.wait(kLook_s);
  }
  throw common::HardwareError(
      "the motor controllers do not answer the coil controller: is their supply on, are "
      "their addresses " +
      addresses_of(controllers_) + " and their mode packet serial at 115200 baud?");
}

SerialLink::Bytes SerialSession::request(wire::MessageType type, const SerialLink::Bytes& body) {
  const std::int64_t stops_before = stops_;
  std::unique_lock<std::mutex> lock(mutex_);
  stop_done_.wait(lock, [this] { return !link_.stop_requested(); });  // a mutex alone lets anyone pass
  if (type == wire::kPulse && stops_ != stops_before) throw_pulse_given_up();
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
