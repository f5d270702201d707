#pragma once

#include <algorithm>

#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// A drive within [-limit, limit].
inline double saturated(double drive, double limit = 1.0) { return std::clamp(drive, -limit, limit); }

/// A drive of two axes within [-limit, limit]: each axis is cut for itself. This is what the rig does to an
/// action.
inline Vector2 saturated(const Vector2& drive, double limit = 1.0) {
  return drive.cwiseMax(-limit).cwiseMin(limit);
}

/// The same bound, but scaled as a whole, so that the direction survives.
inline Vector2 saturated_in_direction(const Vector2& drive) {
  return drive / std::max(1.0, drive.cwiseAbs().maxCoeff());
}

}  // namespace lodestone::geometry
