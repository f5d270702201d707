#pragma once

#include <opencv2/core/mat.hpp>

#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// Finds dish and coils to a few pixels, without a start nearer than the mounting: circles by a vote of all
/// gradients for a centre, then a search over the pose for the place where the gradients lie across all
/// predicted edges at once. Keeps the intrinsics of `start`. Always returns its best; the fit that follows
/// tells whether it is the dish.
CameraModel search_dish(const cv::Mat_<float>& grey, const BenchGeometry& bench, const CameraModel& start);

}  // namespace lodestone::imaging
