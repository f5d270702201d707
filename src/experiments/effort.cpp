#include "lodestone/experiments/effort.h"

#include <cmath>
#include <cstddef>

namespace lodestone::experiments {

void note_effort(const control::ControlLoopConfig& loop, const physics::RigDescription& rig,
                 TrialResult& result) {
  double charge_As = 0.0, heat_J = 0.0;
  for (const TrialSample& sample : result.samples) {
    for (std::size_t coil = 0; coil < sample.step.current_A.size(); ++coil) {
      const double current_A = sample.step.current_A[coil];
      charge_As += std::abs(current_A) * loop.pulse_s;
      heat_J += current_A * current_A * rig.circuit(coil).resistance_20C_ohm * loop.pulse_s;
    }
  }
  const auto note = [&](runs::TrialFigures& score) {
    score.duration_s = result.samples.back().step.time_s;
    score.charge_As = charge_As;
    score.heat_J = heat_J;
  };
  if (result.truth) note(*result.truth);
  note(result.sensed);
}

}  // namespace lodestone::experiments
