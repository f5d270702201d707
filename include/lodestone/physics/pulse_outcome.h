#pragma once

#include "lodestone/geometry/pose2.h"

namespace lodestone::physics {

/// One of the things that a pulse may do to a needle: it comes to lie about `mean`, with independent normal
/// deviations.
struct PulseOutcome {
  double weight = 1.0;  ///< probability
  geometry::Pose2 mean;
  double sigma_x_m = 0.0, sigma_y_m = 0.0, sigma_heading_rad = 0.0;
};

}  // namespace lodestone::physics
