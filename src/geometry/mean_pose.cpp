#include "lodestone/geometry/mean_pose.h"

#include <cmath>

namespace lodestone::geometry {

Pose2 mean_pose(const std::vector<Pose2>& poses) {
  Vector2 sum_m = Vector2::Zero(), along = Vector2::Zero();
  for (const Pose2& pose : poses) {
    sum_m += pose.position_m();
    along += Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  }
  sum_m /= static_cast<double>(poses.size());
  return {sum_m.x(), sum_m.y(), std::atan2(along.y(), along.x())};
}

}  // namespace lodestone::geometry
