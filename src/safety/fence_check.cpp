#include "lodestone/safety/fence_check.h"

#include <fmt/core.h>

namespace lodestone::safety {

void FenceCheck::observe(const control::PoseEstimate& estimate, double) {
  const double distance_m = estimate.pose.position_m().norm();
  if (!(distance_m <= radius_m_))
    throw Distrust(fmt::format(
        "the needle is seen {:g} mm from the dish centre, beyond the fence at {:g} mm (safety.geofence)",
        1e3 * distance_m, 1e3 * radius_m_));
}

}  // namespace lodestone::safety
