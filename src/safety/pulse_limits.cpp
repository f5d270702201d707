#include "lodestone/safety/pulse_limits.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodestone::safety {

/// Coils that make a field together are cut together, or it would point elsewhere.
void PulseLimits::keep_direction(rig::CoilPulse& pulse) const {
  double share = 1.0;
  for (const double current_A : pulse.current_A)
    if (std::abs(current_A) > max_current_A_) share = std::min(share, max_current_A_ / std::abs(current_A));
  if (share < 1.0)
    for (double& current_A : pulse.current_A) current_A *= share;
}

void PulseLimits::check(rig::CoilPulse& pulse, const PulseContext&) {
  if (!std::isfinite(pulse.duration_s) || pulse.duration_s < 0.0)
    throw Distrust(fmt::format("pulse length is {:g} s, must be 0 or more", pulse.duration_s));
  double power_W = 0.0;
  if (!coils_.each.empty()) keep_direction(pulse);
  for (std::size_t coil = 0; coil < pulse.current_A.size(); ++coil) {
    double& current_A = pulse.current_A[coil];
    if (!std::isfinite(current_A))
      throw Distrust(
          fmt::format("current of coil {} is {:g} A, must be a finite number", coils_.name(coil), current_A));
    if (coil >= coils_.count()) {
      if (current_A == 0.0) continue;
      throw Distrust(fmt::format("a current of {:g} A for coil {} of a rig of {} coils", current_A, coil + 1,
                                 coils_.count()));
    }
    current_A = std::clamp(current_A, std::max(coils_.smallest_A(coil), -max_current_A_),
                           std::min(coils_.largest_A(coil), max_current_A_));
    power_W += thermal_.power_W(coil, current_A);
  }
  for (std::size_t one = 0; one < coils_.count(); ++one)
    for (std::size_t other = one + 1; other < coils_.count(); ++other)
      if (pulse.current_A[one] != 0.0 && pulse.current_A[other] != 0.0 && coils_.apart(one, other))
        throw Distrust(fmt::format("{}coils {} and {} driven together ({:g} A and {:g} A)",
                                   coils_.each.empty() ? "opposite " : "", coils_.name(one),
                                   coils_.name(other), pulse.current_A[one], pulse.current_A[other]));
  if (power_W > max_power_W_)
    for (double& current_A : pulse.current_A) current_A *= std::sqrt(max_power_W_ / power_W);
  pulse.duration_s = std::min(pulse.duration_s, max_pulse_s_);
}

}  // namespace lodestone::safety
