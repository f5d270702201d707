#pragma once

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// A pulse needs a pose that was seen since the last one, and that is no older than `max_age_s` when the
/// pulse is given: who decides for longer, decides on what was. Without one there are a few weak pulses that
/// look for a needle that is not seen. Comes after the other pose checks: only poses that they trust count.
class NeedleSeenCheck final : public PoseCheck, public PulseCheck {
 public:
  explicit NeedleSeenCheck(double max_age_s) : max_age_s_(max_age_s) {}
  void observe(const control::PoseEstimate& estimate, double now_s) override;
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;
  /// Throws Distrust for a probe of more than kMostProbe_A, or after kMostProbes since the last pose.
  void check_probe(const rig::CoilPulse& pulse);
  /// There was no pose.
  void forget() { seen_ = false; }

 private:
  static constexpr double kMostProbe_A = 2.0;
  static constexpr int kMostProbes = 6;

  double max_age_s_;
  double stamp_s_ = 0.0;  // of the pose that was seen
  bool seen_ = false;
  int probes_ = 0;
};

}  // namespace lodestone::safety
