#include "lodestone/safety/temperature_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodestone::safety {

namespace {
// A shorter or weaker pulse tells too little of a coil's resistance, and so of its temperature.
constexpr double kMinEstimationPulse_s = 0.1;
constexpr double kMinEstimationCurrent_A = 1.0;
}  // namespace

void TemperatureCheck::check(rig::CoilPulse& pulse, const PulseContext& context) {
  // A device without thermometers says nothing: what its pulses heat is known nevertheless.
  const std::size_t reported = context.status.temperature_C.size();
  if (reported != 0 && reported < known_.size())
    throw Distrust(
        fmt::format("the device reports temperatures of {} coils, the rig has {}", reported, known_.size()));
  for (std::size_t coil = 0; coil < std::min(reported, known_.size()); ++coil)
    check_measured(coil, context.status.temperature_C[coil], context.last);
  for (std::size_t coil = 0; coil < known_.size(); ++coil) {
    if (pulse.current_A[coil] == 0.0) continue;
    const double hot_C = thermal_.after_pulse_C(coil, pulse.current_A[coil], pulse.duration_s);
    if (!(hot_C <= max_temperature_C_))
      throw Distrust(fmt::format("this pulse would heat coil {} to {:g} C, limit is {:g} C",
                                 coils_.name(coil), hot_C, max_temperature_C_));
  }
}

void TemperatureCheck::check_measured(std::size_t coil, double measured_C, const rig::CoilPulse& last) {
  // Written so that a temperature that is not a number stops the run, too.
  if (!(measured_C <= max_temperature_C_))
    throw Distrust(fmt::format("coil {} is at {:g} C, limit is {:g} C", coils_.name(coil), measured_C,
                               max_temperature_C_));
  if (std::abs(last.current_A[coil]) < kMinEstimationCurrent_A || last.duration_s < kMinEstimationPulse_s)
    return;
  const double expected_C = thermal_.temperature_C(coil);
  if (!known_[coil]) {  // nobody knows what the coil did before the run
    known_[coil] = true;
    thermal_.set_temperature_C(coil, measured_C);
  } else if (std::abs(measured_C - expected_C) > tolerance_K_) {
    throw Distrust(fmt::format(
        "coil {} measures {:g} C where its pulses explain {:g} C: check its wires and the supply, or "
        "measure the coils again (lodestone calibrate coils)",
        coils_.name(coil), measured_C, expected_C));
  }
}

}  // namespace lodestone::safety
