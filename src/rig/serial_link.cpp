#include "serial_link.h"

#include <algorithm>
#include <random>
#include <string>
#include <utility>

#include "serial_limits.h"

namespace lodestone::rig {

namespace {

constexpr double kWriteTimeout_s = 0.1;
constexpr double kReadSlice_s = 0.01;

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

SerialLink::Bytes frame_of(std::uint8_t type, std::uint16_t sequence, const SerialLink::Bytes& body) {
  wire::Message message{};
  message.type = type;
  message.sequence = sequence;
  message.length = static_cast<std::uint8_t>(body.size());
  std::copy(body.begin(), body.end(), message.body);
  SerialLink::Bytes frame(wire::kMaxFrame);
  frame.resize(wire::encode_frame(&message, frame.data()));
  return frame;
}

[[noreturn]] void throw_refusal(const SerialLink::Bytes& body) {
  wire::Refusal refusal{};
  if (body.size() == wire::kRefusalSize) wire::get_refusal(body.data(), &refusal);
  std::string why;
  switch (refusal.reason) {
    case wire::kRefusedVersion:
      why = "its firmware speaks protocol " + std::to_string(refusal.detail) + ", this program " +
            std::to_string(wire::kProtocolVersion) + "; flash the firmware of this version";
      break;
    case wire::kRefusedSession:
      throw LinkLost("the coil controller refuses: it has restarted since the run began");
    case wire::kRefusedSequence:
      throw LinkLost("the coil controller refuses: requests came out of order");
    case wire::kRefusedLimit:
      why = "beyond its limit of " + std::to_string(refusal.detail) + " (mA or ms)";
      break;
    case wire::kRefusedFault:
      why = joined(fault_texts(refusal.detail)) +
            "; it stays off until `lodestone rig check --clear` has been run";
      break;
    case wire::kRefusedOpposite:
      why = "two coils that may not be on together are asked for";
      break;
    case wire::kRefusedPower:
      why = "beyond its limit of " + std::to_string(refusal.detail) + " W for all coils together";
      break;
    case wire::kRefusedSetup:
      why = "the motor controllers are not ready: is their supply on?";
      break;
    default:
      why = "it does not understand the request; flash the firmware of this version";
  }
  throw RequestRefused("the coil controller refuses: " + why);
}

}  // namespace

void throw_pulse_given_up() {
  throw RequestRefused("the pulse was given up: another thread has stopped the coils");
}

SerialLink::SerialLink(OpenPort open_port, double reply_timeout_s, std::int64_t tries)
    : open_port_(std::move(open_port)), reply_timeout_s_(reply_timeout_s), tries_(tries) {}

void SerialLink::open() {
  port_ = open_port_();
  port_->discard_input();
  decoder_ = {};
  if (port_->descriptor() >= 0)
    signal_safe_stop_ =
        std::make_unique<common::SignalSafeStop>(port_->descriptor(), frame_of(wire::kStop, 0, {}));
  // Only has to differ from the session before; nothing that is recorded depends on it.
  sequence_ = static_cast<std::uint16_t>(std::random_device()());
}

void SerialLink::close() noexcept {
  signal_safe_stop_.reset();
  port_.reset();
}

void SerialLink::send(const Bytes& frame) {
  const common::DeviceWrite writing;
  port_->write(frame.data(), frame.size(), kWriteTimeout_s);
}

void SerialLink::wait(double time_s) {
  std::uint8_t nothing = 0;
  port_->read(&nothing, 1, time_s);
}

bool SerialLink::receive(wire::MessageType type, bool& stop_sent, Bytes& body) {
  std::uint8_t bytes[wire::kMaxFrame];
  for (double waited_s = 0.0; waited_s < reply_timeout_s_;) {
    if (stop_requested() && type != wire::kStop && !stop_sent) {
      stop_sent = true;
      send(frame_of(wire::kStop, 0, {}));
      if (type == wire::kPulse) throw_pulse_given_up();
    }
    const std::size_t count = port_->read(bytes, sizeof bytes, kReadSlice_s);
    // Bytes without end would hold the loop; a reply is never longer than a few frames of them.
    waited_s += count == 0 ? kReadSlice_s : 1e-4 * static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      wire::Message message{};
      if (!wire::decode_byte(&decoder_, bytes[i], &message) || message.sequence != sequence_) continue;
      body.assign(message.body, message.body + message.length);
      if (message.type == wire::kRefused && !body.empty() && body[0] == type) throw_refusal(body);
      if (message.type == (type | wire::kReply)) return true;
    }
  }
  return false;
}

SerialLink::Bytes SerialLink::exchange(wire::MessageType type, const Bytes& body) {
  if (type != wire::kStop) ++sequence_;  // a stop stands outside the order of requests
  const Bytes frame = frame_of(type, sequence_, body);
  bool stop_sent = false;
  Bytes reply;
  try {
    for (std::int64_t attempt = 0; attempt < tries_; ++attempt) {
      if (attempt > 0) ++repeats_;
      send(frame);
      if (receive(type, stop_sent, reply)) return reply;
    }
  } catch (const RequestRefused&) {
    throw;  // the line is in order
  } catch (const common::HardwareError& error) {
    throw LinkLost(error.what());
  }
  throw LinkLost("the coil controller does not answer (" + std::to_string(tries_) +
                 " tries): is it powered and flashed, is this its port?");
}

}  // namespace lodestone::rig
