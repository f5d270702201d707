#include "lodestone/rig/serial_coils.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "serial_limits.h"
#include "serial_session.h"

namespace lodestone::rig {

void SerialConfig::validate() const {
  std::vector<std::int64_t> sorted = output;
  std::sort(sorted.begin(), sorted.end());
  const bool twice = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  if (twice || (!sorted.empty() && (sorted.front() < 1 || sorted.back() > wire::kMostOutputs)))
    throw common::InvalidConfig("output", output, "name each of the outputs once, from 1 to 16");
}

std::size_t SerialConfig::controllers_for(std::size_t coils) const {
  std::size_t last = 0;
  for (std::size_t coil = 0; coil < coils; ++coil) last = std::max(last, output_of(coil));
  return last / 2 + 1;
}

SerialCoils::SerialCoils(const SerialConfig& config, const physics::CoilsDescription& coils)
    : SerialCoils(config, coils,
                  [config] { return open_serial_port(config.port, static_cast<int>(config.baud)); }) {}

namespace {

/// What the firmware takes of a coil: session.c refuses anything else without a word of which.
void check_resistances(const SerialConfig& config, const physics::CoilsDescription& coils) {
  constexpr double kLeast_ohm = 0.1, kMost_ohm = 30.0, kMostRise = 1.0;
  for (std::size_t i = 0; i < coils.count(); ++i)
    if (!(coils.resistance_20C_ohm[i] >= kLeast_ohm && coils.resistance_20C_ohm[i] <= kMost_ohm))
      throw common::ConfigError(
          fmt::format("rig.coils.resistance_20C_ohm of coil {} = {:g} must be within {:g} .. {:g} for the "
                      "coil controller",
                      coils.name(i), coils.resistance_20C_ohm[i], kLeast_ohm, kMost_ohm));
  const double rise = coils.temperature_coefficient_per_K * (config.max_coil_C - kResistance_C);
  if (!(coils.temperature_coefficient_per_K > 0.0 && rise <= kMostRise))
    throw common::ConfigError(
        fmt::format("rig.coils.temperature_coefficient_per_K = {:g} must be above 0, and such that a coil of "
                    "rig.serial.max_coil_C = {:g} has at most twice its resistance, for the coil controller",
                    coils.temperature_coefficient_per_K, config.max_coil_C));
}

}  // namespace

SerialCoils::SerialCoils(const SerialConfig& config, const physics::CoilsDescription& coils, OpenPort open)
    : config_(config), coils_(coils) {
  config_.validate();
  coils_.validate();
  check_resistances(config_, coils_);
  if (!config_.output.empty() && config_.output.size() != coils_.count())
    throw common::ConfigError("rig.serial.output names " + std::to_string(config_.output.size()) +
                              " outputs, the rig has " + std::to_string(coils_.count()) +
                              " coils (rig.coils); name one for each, or none ([]) for 1, 2, 3, ...");
  controllers_ = static_cast<std::uint8_t>(config_.controllers_for(coils_.count()));
  session_ = std::make_unique<SerialSession>(config_, coils_, std::move(open));
}

SerialCoils::~SerialCoils() {
  if (session_) stop();
}

void SerialCoils::apply(const CoilPulse& pulse) {
  const wire::PulseRequest wired = wire_pulse(config_, coils_, pulse);
  std::vector<std::uint8_t> body(wire::pulse_request_size(controllers_));
  wire::put_pulse_request(body.data(), &wired, controllers_);
  session_->request(wire::kPulse, body);
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
  const wire::CoilState raw = coil_state(session_->request(wire::kStatus), controllers_);
  CoilControllerState state;
  state.ready = (raw.state & wire::kStateReady) != 0;
  state.pulsing = (raw.state & wire::kStatePulsing) != 0;
  state.emergency_stop = (raw.state & wire::kStateEmergencyStop) != 0;
  state.uptime_s = 1e-3 * raw.uptime_ms;
  state.pulses = raw.pulses;
  for (std::size_t i = 0; i < controllers_; ++i) {
    state.supply_V.push_back(0.1 * raw.supply_dV[i]);
    state.board_C.push_back(0.1 * raw.board_dC[i]);
  }
  for (std::size_t i = 0; i < coils_.count(); ++i) {
    state.current_A[i] =
        1e-3 * raw.current_mA[config_.output_of(i)] * static_cast<double>(coils_.polarity[i]);
    state.resistance_ohm[i] = 1e-3 * raw.resistance_mohm[config_.output_of(i)];
  }
  state.faults = fault_texts(raw.faults);
  return state;
}

CoilStatus SerialCoils::status() {
  const CoilControllerState state = this->state();
  CoilStatus status;
  status.current_A = state.current_A;
  for (std::size_t i = 0; i < coils_.count(); ++i) {
    const double rise = state.resistance_ohm[i] / coils_.resistance_20C_ohm[i] - 1.0;
    status.temperature_C[i] = kResistance_C + rise / coils_.temperature_coefficient_per_K;
  }
  status.supply_V = *std::min_element(state.supply_V.begin(), state.supply_V.end());
  status.faults = state.faults;
  return status;
}

CurrentTrace SerialCoils::trace() {
  const std::vector<std::uint8_t> body = session_->request(wire::kTrace);
  CurrentTrace trace;
  if (body.size() < wire::kTraceHeadSize) return trace;
  wire::TraceHead head{};
  const std::uint8_t* at = wire::get_trace_head(body.data(), &head);
  std::size_t coil = 0;
  while (coil < coils_.count() && config_.output_of(coil) != head.coil) ++coil;
  if (coil == coils_.count() ||
      body.size() != std::size_t{wire::kTraceHeadSize} + wire::kTraceSampleSize * head.count)
    return trace;
  trace.coil = static_cast<int>(coil);
  const auto polarity = static_cast<double>(coils_.polarity[coil]);
  for (std::size_t i = 0; i < head.count; ++i) {
    wire::TraceSample sample{};
    at = wire::get_trace_sample(at, &sample);
    trace.samples.emplace_back(1e-4 * sample.time_100us, 1e-3 * sample.current_mA * polarity);
  }
  return trace;
}

CoilControllerInfo SerialCoils::info() const { return session_->info(); }
std::int64_t SerialCoils::repeats() const { return session_->repeats(); }
std::int64_t SerialCoils::connections() const { return session_->connections(); }
void SerialCoils::ping() { session_->request(wire::kPing); }
void SerialCoils::clear_faults() { session_->request(wire::kClear); }

}  // namespace lodestone::rig
