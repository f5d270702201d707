#include "lodestone/safety/duty_check.h"

#include <fmt/core.h>

#include <algorithm>

namespace lodestone::safety {

void DutyCheck::check(rig::CoilPulse& pulse, const PulseContext& context) {
  for (std::size_t coil = 0; coil < on_level_s_.size(); ++coil) {
    double& level_s = on_level_s_[coil];
    if (context.last.current_A[coil] != 0.0) level_s += context.on_s;
    level_s = std::max(0.0, level_s - max_duty_ * context.passed_s);
    if (pulse.current_A[coil] != 0.0 &&
        level_s + (1.0 - max_duty_) * pulse.duration_s > max_duty_ * window_s_)
      throw Distrust(fmt::format("coil {} would be on for more than {:g} % of the time over {:g} s",
                                 coils_.name(coil), 100.0 * max_duty_, window_s_));
  }
}

}  // namespace lodestone::safety
