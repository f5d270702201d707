#pragma once

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// A pulse needs a pose that was seen since the last one, but for a few weak ones that look for a needle that
/// is not seen. Comes after the other pose checks: only poses that they trust count.
class NeedleSeenCheck final : public PoseCheck, public PulseCheck {
 public:
  void observe(const control::PoseEstimate& estimate, double now_s) override;
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;
  /// Throws Distrust for a probe of more than kMostProbe_A, or after kMostProbes since the last pose.
  void check_probe(const rig::CoilPulse& pulse);
  /// There was no pose.
  void forget() { seen_ = false; }

 private:
  static constexpr double kMostProbe_A = 2.0;
  static constexpr int kMostProbes = 6;

  bool seen_ = false;
  int probes_ = 0;
};

}  // namespace lodestone::safety
