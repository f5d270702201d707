#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// The mean of one pose or more; of headings the direction of the sum of their unit vectors.
Pose2 mean_pose(const std::vector<Pose2>& poses);

}  // namespace lodestone::geometry
