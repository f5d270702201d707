#pragma once

#include <opencv2/core/mat.hpp>

#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// The image with what a calibration says drawn in, for a person to judge it: dish floor and rim, the
/// coils' base lines, the axes, and a grid of 10 mm on the floor. `image`: 8-bit BGR of the camera's size.
cv::Mat calibration_overlay(const cv::Mat& image, const CameraModel& camera, const BenchGeometry& bench);

}  // namespace lodestone::imaging
