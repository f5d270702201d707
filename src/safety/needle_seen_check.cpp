#include "lodestone/safety/needle_seen_check.h"

namespace lodestone::safety {

void NeedleSeenCheck::observe(const control::PoseEstimate&, double) { seen_ = true; }

void NeedleSeenCheck::check(rig::CoilPulse&, const PulseContext&) {
  if (!seen_) throw Distrust("a pulse was asked for, but nobody has seen the needle since the last");
  seen_ = false;
}

}  // namespace lodestone::safety
