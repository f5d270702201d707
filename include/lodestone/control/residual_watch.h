#pragma once

#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/control/motion_model.h"
#include "lodestone/control/stall_memory.h"
#include "lodestone/task/observation.h"

namespace lodestone::control {

/// Notices that a rig is no longer the one that a simulator and an identified gain describe: a coil that went
/// dead or was turned, another needle. A pulse is surprising where its motion is less likely than every one
/// of some that are drawn from the prediction, which happens to one pulse in twenty on a rig that is as
/// predicted, whatever the pulse (a posterior predictive check); surprises that come too often are found by
/// Page's CUSUM (Biometrika, 1954).
class ResidualWatch {
 public:
  /// A needle that came less far than `still_m` and `still_rad` has not moved.
  ResidualWatch(MotionModel model, double still_m, double still_rad);

  /// Back to a rig as described.
  void reset();
  /// One more pulse, on a rig of this gain. A stall that is repeated is no surprise.
  void check(const SeenPulse& pulse, const task::DriveGain& gain);

  /// Logarithm of how much more likely the surprises since some pulse are on a changed rig; 0 at least.
  double evidence() const { return evidence_; }
  /// Whether that is enough to tell somebody.
  bool changed() const;

 private:
  MotionModel model_;
  StallMemory stalls_;
  common::RandomStream random_;
  double evidence_ = 0.0;
  std::vector<SeenPulse> draws_;
  std::vector<double> ratio_;
};

}  // namespace lodestone::control
