#pragma once

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// A pulse needs a pose that was seen since the last one. Comes after the other pose checks: only poses that
/// they trust count.
class NeedleSeenCheck final : public PoseCheck, public PulseCheck {
 public:
  void observe(const control::PoseEstimate& estimate, double now_s) override;
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;
  /// There was no pose.
  void forget() { seen_ = false; }

 private:
  bool seen_ = false;
};

}  // namespace lodestone::safety
