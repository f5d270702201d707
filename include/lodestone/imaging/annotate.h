#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// What a person wants to see in a frame of a run. Everything is in the dish frame; what is left empty is not
/// drawn.
struct Annotation {
  BenchGeometry bench;  ///< sizes of dish, coils and needle

  std::optional<geometry::Pose2> pose;  ///< estimated, of the needle's middle
  double position_sigma_m = 0.0;        ///< its RMS error as it is believed to be: drawn twice as wide
  std::string no_pose_reason;           ///< shown when there is no pose,
  std::optional<geometry::Vector2> last_seen_m;  ///< and where the needle was when there was one
  std::optional<geometry::Vector2> target_m;
  std::vector<geometry::Vector2> reference_m;  ///< path to follow
  /// Where the head should point at the target, and along the path, at some of its points.
  std::optional<double> target_heading_rad;
  std::vector<geometry::Pose2> reference_headings;
  /// Path so far, in the stretches along which the needle was seen; the way between them is dashed.
  std::vector<std::vector<geometry::Vector2>> travelled_m;

  /// In the order of the bench's coils. A positive current pulls towards its coil: its arrow points outwards.
  std::optional<std::vector<double>> coil_current_A;
  double max_current_A = 15.0;  ///< full length of an arrow

  std::string task;
  std::optional<double> time_s;
  std::optional<double> error_m;
};

/// Draws into `image` (8-bit BGR, of the camera's size), antialiased, in colours that the colour-blind can
/// tell apart (Okabe and Ito 2008): dish rim white, reference blue with ticks along its headings, path so far
/// orange, target purple cross with a line along its heading, pose vermilion with a yellow head, where it was
/// seen last a yellow ring. Stroke widths follow the image's height. Throws LogicFault when the image is of
/// another type or size.
void annotate(cv::Mat& image, const CameraModel& camera, const Annotation& annotation);

}  // namespace lodestone::imaging
