#include "lodestone/geometry/keep_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::geometry {

double KeepOut::clearance_m(const Pose2& pose, const Zone& zone) const {
  const Vector2 to_head_m =
      0.5 * needle_length_m * Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  const Vector2 middle_m = pose.position_m();
  return zone.distance_m(middle_m - to_head_m, middle_m + to_head_m) - 0.5 * needle_diameter_m;
}

double KeepOut::clearance_m(const Pose2& pose) const {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Zone& zone : zones) least_m = std::min(clearance_m(pose, zone), least_m);
  return least_m;
}

double KeepOut::clearance_m(const Vector2& from_m, const Vector2& to_m) const {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Zone& zone : zones)
    least_m = std::min(zone.distance_m(from_m, to_m) - 0.5 * needle_diameter_m, least_m);
  return least_m;
}

}  // namespace lodestone::geometry
