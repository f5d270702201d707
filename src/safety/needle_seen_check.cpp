#include "lodestone/safety/needle_seen_check.h"

#include <fmt/core.h>

#include <cmath>

namespace lodestone::safety {

void NeedleSeenCheck::observe(const control::PoseEstimate& estimate, double) {
  seen_ = true;
  stamp_s_ = estimate.stamp_s;
  if (estimate.valid) probes_ = 0;
}

void NeedleSeenCheck::check(rig::CoilPulse&, const PulseContext& context) {
  if (!seen_) throw Distrust("a pulse was asked for, but nobody has seen the needle since the last");
  seen_ = false;
  const double age_s = context.now_s - stamp_s_;
  if (!(age_s <= max_age_s_))
    throw Distrust(
        fmt::format("the pulse comes {:g} s after the pose that it answers, limit is {:g} s: was the program "
                    "held up?",
                    age_s, max_age_s_));
}

void NeedleSeenCheck::check_probe(const rig::CoilPulse& pulse) {
  for (const double current_A : pulse.current_A)
    if (!(std::abs(current_A) <= kMostProbe_A))
      throw Distrust(fmt::format("a probe of {:g} A for a needle that is not seen, limit is {:g} A",
                                 current_A, kMostProbe_A));
  if (++probes_ > kMostProbes)
    throw Distrust(fmt::format("{} probes have not found the needle", kMostProbes));
  seen_ = false;
}

}  // namespace lodestone::safety
