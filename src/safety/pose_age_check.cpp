#include "lodestone/safety/pose_age_check.h"

#include <fmt/core.h>

#include <cmath>

namespace lodestone::safety {

void PoseAgeCheck::observe(const control::PoseEstimate& estimate, double now_s) {
  const double age_s = now_s - estimate.stamp_s;
  if (!(std::abs(age_s) <= max_age_s_))
    throw Distrust(
        fmt::format("the pose is {:g} s old, limit is {:g} s: has the camera stalled, or was a clock set?",
                    age_s, max_age_s_));
  if (has_pose_ && now_s > seen_s_ && !(estimate.stamp_s > stamp_s_))
    throw Distrust("the sensor gave the same pose, or an older one, again: has the camera stalled?");
  has_pose_ = true;
  stamp_s_ = estimate.stamp_s;
  seen_s_ = now_s;
}

}  // namespace lodestone::safety
