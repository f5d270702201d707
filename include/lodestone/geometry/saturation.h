#pragma once

#include <algorithm>

#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// A drive within [-limit, limit].
inline double saturated(double drive, double limit = 1.0) { return std::clamp(drive, -limit, limit); }

/// Each number of a drive within [-limit, limit], cut for itself. This is what the rig does to an action.
inline Drive saturated(const Drive& drive, double limit = 1.0) {
  return drive.cwiseMax(-limit).cwiseMin(limit);
}

/// The same bound, but scaled as a whole, so that the direction survives.
inline Drive saturated_in_direction(const Drive& drive) {
  return drive / std::max(1.0, drive.cwiseAbs().maxCoeff());
}

}  // namespace lodestone::geometry
