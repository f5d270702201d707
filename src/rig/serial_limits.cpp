#include "serial_limits.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::rig {

namespace {

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

/// A bit for each coil that must be off while this one is on.
unsigned apart_from(const physics::CoilsDescription& coils, std::size_t coil) {
  unsigned bits = 0;
  for (std::size_t other = 0; other < coils.count(); ++other)
    if (other != coil && coils.apart(coil, other)) bits |= 1u << other;
  return bits;
}

/// How many coils may be on at once.
int most_together(const physics::CoilsDescription& coils) {
  const std::size_t count = coils.count();
  std::vector<unsigned> apart;
  for (std::size_t coil = 0; coil < count; ++coil) apart.push_back(apart_from(coils, coil));
  int most = 0;
  for (unsigned on = 0; on < 1u << count; ++on) {
    int together = 0;
    bool allowed = true;
    for (std::size_t coil = 0; coil < count; ++coil) {
      if ((on >> coil & 1u) == 0) continue;
      ++together;
      allowed = allowed && (apart[coil] & on) == 0;
    }
    if (allowed) most = std::max(most, together);
  }
  return most;
}

std::int16_t milliamperes(double current_A) {
  return static_cast<std::int16_t>(std::clamp(std::lround(1e3 * current_A), -32767L, 32767L));
}

}  // namespace

std::vector<std::string> fault_texts(unsigned bits) {
  std::vector<std::string> texts;
  for (int i = 0; i < wire::kFaultCount; ++i)
    if ((bits >> i & 1u) != 0) texts.push_back(kFaults[i]);
  return texts;
}

wire::CoilLimits wire_limits(const SerialConfig& config, const physics::CoilsDescription& coils) {
  const auto scaled = [](double value, double scale) {
    return static_cast<std::uint16_t>(std::clamp(std::lround(value * scale), 0L, 65535L));
  };
  wire::CoilLimits limits{};
  limits.max_current_mA = scaled(coils.max_current_A, 1e3);
  limits.max_pulse_ms = scaled(config.max_pulse_s, 1e3);
  limits.max_duty_permille = scaled(config.max_duty, 1e3);
  limits.duty_window_ms = scaled(config.duty_window_s, 1e3);
  limits.min_supply_dV = scaled(config.min_supply_V, 10.0);
  limits.max_board_dC = scaled(config.max_board_C, 10.0);
  const double hot = 1.0 + coils.temperature_coefficient_per_K * (config.max_coil_C - kResistance_C);
  const double largest_ohm =
      *std::max_element(coils.resistance_20C_ohm.begin(), coils.resistance_20C_ohm.end());
  for (std::size_t output = 0; output < wire::kMostOutputs; ++output) {  // of those without a coil, too
    limits.resistance_mohm[output] = scaled(largest_ohm, 1e3);
    limits.opposite[output] = static_cast<std::uint8_t>(output);
  }
  for (std::size_t i = 0; i < coils.count(); ++i) {
    const std::size_t output = config.output_of(i);
    limits.resistance_mohm[output] = scaled(coils.resistance_20C_ohm[i], 1e3);
    for (std::size_t other = 0; other < coils.count(); ++other)
      if (other != i && coils.apart(i, other))
        limits.opposite[output] = static_cast<std::uint8_t>(config.output_of(other));
  }
  limits.max_resistance_permille = scaled(hot, 1e3);
  // As many coils as may be on, at their largest current and as hot as they may get.
  limits.max_power_W =
      scaled(most_together(coils) * coils.max_current_A * coils.max_current_A * largest_ohm * hot, 1.0);
  return limits;
}

bool need_ranges(const physics::CoilsDescription& coils) {
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    const unsigned apart = apart_from(coils, coil);
    if (coils.largest_A(coil) != coils.max_current_A || coils.smallest_A(coil) != -coils.max_current_A ||
        (apart & (apart - 1u)) != 0)
      return true;
  }
  return false;
}

wire::CoilRanges wire_ranges(const SerialConfig& config, const physics::CoilsDescription& coils) {
  wire::CoilRanges ranges{};
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    const std::size_t output = config.output_of(coil);
    const bool reversed = coils.polarity[coil] < 0;
    ranges.smallest_mA[output] = milliamperes(reversed ? -coils.largest_A(coil) : coils.smallest_A(coil));
    ranges.largest_mA[output] = milliamperes(reversed ? -coils.smallest_A(coil) : coils.largest_A(coil));
    for (std::size_t other = 0; other < coils.count(); ++other)
      if (other != coil && coils.apart(coil, other))
        ranges.not_with[output] =
            static_cast<std::uint16_t>(ranges.not_with[output] | 1u << config.output_of(other));
  }
  return ranges;
}

wire::PulseRequest wire_pulse(const SerialConfig& config, const physics::CoilsDescription& coils,
                              const CoilPulse& pulse) {
  wire::PulseRequest request{};
  for (std::size_t i = 0; i < coils.count(); ++i) {
    if (!(pulse.current_A[i] >= coils.smallest_A(i) && pulse.current_A[i] <= coils.largest_A(i)))
      throw common::HardwareError("serial coils: current of coil " + coils.name(i) + " = " +
                                  std::to_string(pulse.current_A[i]) + " A is refused; it must be within " +
                                  std::to_string(coils.smallest_A(i)) + " and " +
                                  std::to_string(coils.largest_A(i)) + " A");
    const double wired_A = pulse.current_A[i] * static_cast<double>(coils.polarity[i]);
    request.current_mA[config.output_of(i)] = static_cast<std::int16_t>(std::lround(1e3 * wired_A));
  }
  if (!(pulse.duration_s >= 0.0 && pulse.duration_s <= config.max_pulse_s))
    throw common::HardwareError("serial coils: duration = " + std::to_string(pulse.duration_s) +
                                " s is refused; it must be within 0 and " +
                                std::to_string(config.max_pulse_s) + " s");
  request.length_ms = static_cast<std::uint16_t>(std::lround(1e3 * pulse.duration_s));
  return request;
}

wire::CoilState coil_state(const std::vector<std::uint8_t>& body, std::uint8_t controllers) {
  if (body.size() != wire::coil_state_size(controllers))
    throw common::HardwareError(
        "the coil controller's status has the wrong size; flash the firmware of this version");
  wire::CoilState state{};
  wire::get_coil_state(body.data(), &state, controllers);
  return state;
}

}  // namespace lodestone::rig
