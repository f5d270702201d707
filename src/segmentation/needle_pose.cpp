#include "lodestone/segmentation/needle_pose.h"

#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::segmentation {

geometry::Pose2 draw_needle_pose(const imaging::BenchGeometry& bench, common::RandomStream& random) {
  const double half_m = 0.5 * bench.needle_length_m;
  for (;;) {
    const double r = bench.dish_radius_m * std::sqrt(random.uniform());
    const double angle = random.uniform(-geometry::kPi, geometry::kPi);
    const geometry::Pose2 pose{r * std::cos(angle), r * std::sin(angle),
                               random.uniform(-geometry::kPi, geometry::kPi)};
    const geometry::Vector2 half(half_m * std::cos(pose.heading_rad), half_m * std::sin(pose.heading_rad));
    const double reach_m = bench.dish_radius_m - 0.5 * bench.needle_diameter_m;
    if ((pose.position_m() + half).norm() < reach_m && (pose.position_m() - half).norm() < reach_m)
      return {pose.x_m, pose.y_m, bench.sphere ? 0.0 : pose.heading_rad};
  }
}

}  // namespace lodestone::segmentation
