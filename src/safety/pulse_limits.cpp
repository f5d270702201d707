#include "lodestone/safety/pulse_limits.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/saturation.h"

namespace lodestone::safety {

void PulseLimits::check(rig::CoilPulse& pulse, const PulseContext&) {
  if (!std::isfinite(pulse.duration_s) || pulse.duration_s < 0.0)
    throw Distrust(fmt::format("pulse length is {:g} s, must be 0 or more", pulse.duration_s));
  double power_W = 0.0;
  for (std::size_t coil = 0; coil < pulse.current_A.size(); ++coil) {
    double& current_A = pulse.current_A[coil];
    if (!std::isfinite(current_A))
      throw Distrust(fmt::format("current of coil {} is {:g} A, must be a finite number",
                                 rig::kCoilNames[coil], current_A));
    current_A = geometry::saturated(current_A, max_current_A_);
    power_W += thermal_.power_W(static_cast<int>(coil), current_A);
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (pulse.current_A[2 * axis] != 0.0 && pulse.current_A[2 * axis + 1] != 0.0)
      throw Distrust(fmt::format("opposite coils {} and {} driven together ({:g} A and {:g} A)",
                                 rig::kCoilNames[2 * axis], rig::kCoilNames[2 * axis + 1],
                                 pulse.current_A[2 * axis], pulse.current_A[2 * axis + 1]));
  if (power_W > max_power_W_)
    for (double& current_A : pulse.current_A) current_A *= std::sqrt(max_power_W_ / power_W);
  pulse.duration_s = std::min(pulse.duration_s, max_pulse_s_);
}

}  // namespace lodestone::safety
