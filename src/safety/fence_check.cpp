#include "lodestone/safety/fence_check.h"

#include <fmt/core.h>

namespace lodestone::safety {

void FenceCheck::observe(const control::PoseEstimate& estimate, double) {
  // With the 2 sigma by which it may lie further out.
  const double distance_m = estimate.pose.position_m().norm() + 2.0 * estimate.position_sigma_m;
  if (!(distance_m <= radius_m_))
    throw Distrust(fmt::format(
        "the needle may lie {:g} mm from the dish centre, beyond the fence at {:g} mm (safety.geofence)",
        1e3 * distance_m, 1e3 * radius_m_));
}

}  // namespace lodestone::safety
