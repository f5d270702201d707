#include "lodestone/rig/serial_coils.h"

#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "serial_limits.h"
#include "serial_session.h"

namespace lodestone::rig {

namespace {

/// Temperature that the description's resistances are of.
constexpr double kResistance_C = 20.0;

constexpr double kWriteTimeout_s = 0.1;
constexpr const char* kCoilNames[kCoilCount] = {"+x", "-x", "+y", "-y"};

const char* const kFaults[wire::kFaultCount] = {
    "the PC fell silent during a pulse",
    "a motor controller does not answer: check its power and its serial wires",
    "over-current",
    "current in a coil that is switched off: a motor controller has failed, cut its supply",
    "no current in a driven coil: is it connected?",
    "a motor controller is too hot",
    "a coil is too hot",
    "the supply is too low",
    "the emergency stop is open",
    "a coil was on for too large a fraction of the time",
    "the coil controller's watchdog has restarted it",
    "a motor controller reports a fault (emergency stop, temperature or over-current)",
};

std::vector<std::string> fault_texts(unsigned bits) {
  std::vector<std::string> texts;
  for (int i = 0; i < wire::kFaultCount; ++i)
    if ((bits >> i & 1u) != 0) texts.push_back(kFaults[i]);
  return texts;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

std::vector<std::uint8_t> frame_of(std::uint8_t type, std::uint16_t sequence,
                                   const std::vector<std::uint8_t>& body) {
  wire::Message message{};
  message.type = type;
  message.sequence = sequence;
  message.length = static_cast<std::uint8_t>(body.size());
  std::copy(body.begin(), body.end(), message.body);
  std::vector<std::uint8_t> frame(wire::kMaxFrame);
  frame.resize(wire::encode_frame(&message, frame.data()));
  return frame;
}

/// An answer, but no.
class Refusal final : public common::HardwareError {
 public:
  using HardwareError::HardwareError;
};

/// Nobody answers, or somebody who knows nothing of this session: the next call has to connect anew.
class LinkLost final : public common::HardwareError {
 public:
  using HardwareError::HardwareError;
};

[[noreturn]] void throw_refusal(const std::vector<std::uint8_t>& body) {
  const unsigned reason = body.size() == wire::kRefusedBodySize ? body[1] : 0;
  const unsigned detail = body.size() == wire::kRefusedBodySize ? wire::get_u16(body.data() + 2) : 0;
  std::string why;
  switch (reason) {
    case wire::kRefusedVersion:
      why = "its firmware speaks protocol " + std::to_string(detail) + ", this program " +
            std::to_string(wire::kProtocolVersion) + "; flash the firmware of this version";
      break;
    case wire::kRefusedSession:
      throw LinkLost("the coil controller refuses: it has restarted since the run began");
    case wire::kRefusedSequence:
      throw LinkLost("the coil controller refuses: requests came out of order");
    case wire::kRefusedLimit:
      why = "beyond its limit of " + std::to_string(detail) + " (mA or ms)";
      break;
    case wire::kRefusedFault:
      why = joined(fault_texts(detail)) + "; it stays off until `lodestone rig check --clear` has been run";
      break;
    case wire::kRefusedSetup:
      why = "the motor controllers are not ready: is their supply on?";
      break;
    default:
      why = "it does not understand the request; flash the firmware of this version";
  }
  throw Refusal("the coil controller refuses: " + why);
}

}  // namespace

struct SerialCoils::Decoder {
  wire::FrameDecoder frames{};
};

SerialCoils::SerialCoils(const SerialConfig& config, const physics::CoilsDescription& coils)
    : SerialCoils(config, coils,
                  [config] { return open_serial_port(config.port, static_cast<int>(config.baud)); }) {}

SerialCoils::SerialCoils(const SerialConfig& config, const physics::CoilsDescription& coils, OpenPort open)
    : config_(config), coils_(coils), open_(std::move(open)), decoder_(std::make_unique<Decoder>()) {
  coils_.validate();
  ensure_connected();
}

SerialCoils::~SerialCoils() { stop(); }

void SerialCoils::disconnect() noexcept {
  signal_safe_stop_.reset();
  port_.reset();
}

void SerialCoils::ensure_connected() {
  if (port_) return;
  try {
    connect();
    configure();
    wait_until_ready();
  } catch (...) {
    disconnect();
    throw;
  }
}

void SerialCoils::connect() {
  port_ = open_();
  ++connections_;
  port_->discard_input();
  decoder_->frames = {};
  if (port_->descriptor() >= 0)
    signal_safe_stop_ =
        std::make_unique<common::SignalSafeStop>(port_->descriptor(), frame_of(wire::kStop, 0, {}));
  // Only has to differ from the session before; nothing that is recorded depends on it.
  std::random_device random;
  sequence_ = static_cast<std::uint16_t>(random());
  std::vector<std::uint8_t> body(wire::kHelloBody);
  wire::put_u32(wire::put_u8(body.data(), wire::kProtocolVersion), random());
  std::vector<std::uint8_t> reply;
  // Opening the port resets many Arduinos, whose bootloader then listens for about a second.
  for (int round = 0;; ++round) {
    try {
      reply = exchange(wire::kHello, body);
      break;
    } catch (const LinkLost&) {
      if (round * static_cast<double>(config_.tries) * config_.reply_timeout_s > config_.setup_timeout_s)
        throw;
    }
  }
  if (reply.size() != wire::kHelloReplyBody)
    throw common::HardwareError("what answers on the serial port is not the coil controller");
  info_.protocol = reply[0];
  info_.firmware = std::to_string(reply[1]) + "." + std::to_string(reply[2]) + "." + std::to_string(reply[3]);
  info_.reset_cause = reply[4];
}

void SerialCoils::configure() {
  wire::CoilLimits limits{};
  const auto scaled = [](double value, double scale) {
    return static_cast<std::uint16_t>(std::clamp(std::lround(value * scale), 0L, 65535L));
  };
  limits.max_current_mA = scaled(coils_.max_current_A, 1e3);
  limits.max_pulse_ms = scaled(config_.max_pulse_s, 1e3);
  limits.max_duty_permille = scaled(config_.max_duty, 1e3);
  limits.duty_window_ms = scaled(config_.duty_window_s, 1e3);
  limits.min_supply_dV = scaled(config_.min_supply_V, 10.0);
  limits.max_board_dC = scaled(config_.max_board_C, 10.0);
  for (std::size_t i = 0; i < kCoilCount; ++i)
    limits.resistance_mohm[i] = scaled(coils_.resistance_20C_ohm[i], 1e3);
  limits.max_resistance_permille =
      scaled(1.0 + coils_.temperature_coefficient_per_K * (config_.max_coil_C - kResistance_C), 1e3);
  std::vector<std::uint8_t> body(wire::kConfigureBody);
  wire::put_limits(body.data(), &limits);
  exchange(wire::kConfigure, body);
}

void SerialCoils::wait_until_ready() {
  constexpr double kLook_s = 0.02;
  for (double waited_s = 0.0; waited_s < config_.setup_timeout_s; waited_s += kLook_s) {
    if (decode_state(exchange(wire::kStatus, {})).ready) return;
    std::uint8_t nothing = 0;  // the port's time is the only time there is here
    port_->read(&nothing, 1, kLook_s);
  }
  throw common::HardwareError(
      "the motor controllers do not answer the coil controller: is their supply on, are "
      "their addresses 0x80 and 0x81 and their mode packet serial at 115200 baud?");
}

std::vector<std::uint8_t> SerialCoils::exchange(std::uint8_t type, const std::vector<std::uint8_t>& body) {
  if (type != wire::kStop) ++sequence_;  // a stop stands outside the order of requests
  const std::vector<std::uint8_t> frame = frame_of(type, sequence_, body);
  constexpr double kReadSlice_s = 0.01;
  try {
    for (std::int64_t attempt = 0; attempt < config_.tries; ++attempt) {
      if (attempt > 0) ++repeats_;
      port_->write(frame.data(), frame.size(), kWriteTimeout_s);
      std::uint8_t bytes[wire::kMaxFrame];
      for (double waited_s = 0.0; waited_s < config_.reply_timeout_s;) {
        const std::size_t count = port_->read(bytes, sizeof bytes, kReadSlice_s);
        if (count == 0) waited_s += kReadSlice_s;
        // Bytes without end would hold the loop; a reply is never longer than a few frames of them.
        else
          waited_s += 1e-4 * static_cast<double>(count);
        for (std::size_t i = 0; i < count; ++i) {
          wire::Message message{};
          if (!wire::decode_byte(&decoder_->frames, bytes[i], &message) || message.sequence != sequence_)
            continue;
          const std::vector<std::uint8_t> content(message.body, message.body + message.length);
          if (message.type == wire::kRefused && !content.empty() && content[0] == type)
            throw_refusal(content);
          if (message.type == (type | wire::kReply)) return content;
        }
      }
    }
  } catch (const Refusal&) {
    throw;  // the line is in order
  } catch (const common::HardwareError& error) {
    throw LinkLost(error.what());
  }
  throw LinkLost("the coil controller does not answer (" + std::to_string(config_.tries) +
                 " tries): is it powered and flashed, is this its port?");
}

std::vector<std::uint8_t> SerialCoils::request(std::uint8_t type, const std::vector<std::uint8_t>& body) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ensure_connected();
  try {
    return exchange(type, body);
  } catch (const LinkLost&) {
    disconnect();
    throw;
  }
}

void SerialCoils::apply(const CoilPulse& pulse) {
  std::vector<std::uint8_t> body(wire::kPulseBody);
  std::uint8_t* at = body.data();
  for (std::size_t i = 0; i < kCoilCount; ++i) {
    if (!(std::abs(pulse.current_A[i]) <= coils_.max_current_A))
      throw common::HardwareError(std::string("serial coils: current of coil ") + kCoilNames[i] + " = " +
                                  std::to_string(pulse.current_A[i]) + " A is refused; it must be within +-" +
                                  std::to_string(coils_.max_current_A) + " A");
    const double wired_A = pulse.current_A[i] * static_cast<double>(coils_.polarity[i]);
    at = wire::put_u16(at, static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(1e3 * wired_A))));
  }
  if (!(pulse.duration_s >= 0.0 && pulse.duration_s <= config_.max_pulse_s))
    throw common::HardwareError("serial coils: duration = " + std::to_string(pulse.duration_s) +
                                " s is refused; it must be within 0 and " +
                                std::to_string(config_.max_pulse_s) + " s");
  wire::put_u16(at, static_cast<std::uint16_t>(std::lround(1e3 * pulse.duration_s)));
  request(wire::kPulse, body);
}

void SerialCoils::stop() noexcept {
  try {
    session_->stop();
  } catch (const std::exception& error) {
    try {
      common::log_error(std::string("stop: ") + error.what() +
                        "; the firmware ends the pulse by itself, cut the supply if it does not");
    } catch (...) {
    }
  } catch (...) {
  }
}

CoilControllerState SerialCoils::state() {
  const wire::CoilState raw = coil_state(session_->request(wire::kStatus));
  CoilControllerState state;
  state.ready = (raw.state & wire::kStateReady) != 0;
  state.pulsing = (raw.state & wire::kStatePulsing) != 0;
  state.emergency_stop = (raw.state & wire::kStateEmergencyStop) != 0;
  state.uptime_s = 1e-3 * raw.uptime_ms;
  state.pulses = raw.pulses;
  for (std::size_t i = 0; i < 2; ++i) {
    state.supply_V[i] = 0.1 * raw.supply_dV[i];
    state.board_C[i] = 0.1 * raw.board_dC[i];
  }
  for (std::size_t i = 0; i < kCoilCount; ++i) {
    state.current_A[i] = 1e-3 * raw.current_mA[i] * static_cast<double>(coils_.polarity[i]);
    state.resistance_ohm[i] = 1e-3 * raw.resistance_mohm[i];
  }
  state.faults = fault_texts(raw.faults);
  return state;
}

CoilStatus SerialCoils::status() {
  const CoilControllerState state = this->state();
  CoilStatus status;
  status.current_A = state.current_A;
  for (std::size_t i = 0; i < kCoilCount; ++i) {
    const double rise = state.resistance_ohm[i] / coils_.resistance_20C_ohm[i] - 1.0;
    status.temperature_C[i] = kResistance_C + rise / coils_.temperature_coefficient_per_K;
  }
  status.faults = state.faults;
  return status;
}

CurrentTrace SerialCoils::trace() {
  const std::vector<std::uint8_t> body = session_->request(wire::kTrace);
  CurrentTrace trace;
  if (body.size() < 2 || body[0] >= kCoilCount || body.size() != 2u + 4u * body[1]) return trace;
  trace.coil = body[0];
  for (std::size_t i = 0; i < body[1]; ++i)
    trace.samples.push_back(
        {1e-4 * wire::get_u16(body.data() + 2 + 4 * i),
         1e-3 * wire::get_i16(body.data() + 4 + 4 * i) * static_cast<double>(coils_.polarity[body[0]])});
  return trace;
}

CoilControllerInfo SerialCoils::info() const { return session_->info(); }
std::int64_t SerialCoils::repeats() const { return session_->repeats(); }
std::int64_t SerialCoils::connections() const { return session_->connections(); }
void SerialCoils::ping() { session_->request(wire::kPing); }
void SerialCoils::clear_faults() { session_->request(wire::kClear); }

}  // namespace lodestone::rig
