#pragma once

#include <Eigen/Core>

#include "lodestone/geometry/angle.h"

namespace lodestone::geometry {

using Vector2 = Eigen::Vector2d;

constexpr double kMmPerM = 1000.0;

/// Pose in the dish frame: origin at the dish centre, x towards coil +x, y towards coil +y, heading
/// counter-clockwise from +x, pointing from tail to head.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;

  Vector2 position_m() const { return {x_m, y_m}; }
};

}  // namespace lodestone::geometry
