#include "lodestone/control/gain_correction.h"

#include <cmath>

#include "lodestone/geometry/saturation.h"

namespace lodestone::control {

geometry::Drive GainCorrection::act(const task::Observation& observation) {
  const double gain = std::exp(observation.drive_gain.value_or(task::DriveGain{}).log_mean);
  task::Observation known = observation;
  known.drive_gain.reset();
  known.last_action = geometry::saturated(gain * observation.last_action);
  return geometry::saturated_in_direction(inner_->act(known) / gain);
}

}  // namespace lodestone::control
