#pragma once

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// Poses that are too old, or that were seen before: the camera has stalled.
class PoseAgeCheck final : public PoseCheck {
 public:
  explicit PoseAgeCheck(double max_age_s) : max_age_s_(max_age_s) {}
  void observe(const control::PoseEstimate& estimate, double now_s) override;

 private:
  double max_age_s_;
  bool has_pose_ = false;
  double stamp_s_ = 0.0;
  double seen_s_ = 0.0;  // when that pose was handed in
};

}  // namespace lodestone::safety
