#pragma once

#include "lodestone/common/random.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/bench.h"

namespace lodestone::segmentation {

/// A pose with the whole needle inside the dish, uniform over the disc and over headings.
geometry::Pose2 draw_needle_pose(const imaging::BenchGeometry& bench, common::RandomStream& random);

}  // namespace lodestone::segmentation
