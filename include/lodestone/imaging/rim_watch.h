#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// Whether a camera still stands where it was calibrated: holds the rim of the dish and the base lines of the
/// coils, in every image, against where the calibration has them. What camera_moved_m() finds out by a whole
/// fit is looked at here at fewer places and without one, for every image, and trusted up to about a
/// millimetre.
class RimWatch {
 public:
  RimWatch(const Calibration& calibration, const BenchGeometry& bench);
  ~RimWatch();
  RimWatch(RimWatch&&) noexcept;
  RimWatch& operator=(RimWatch&&) noexcept;

  /// How far they lie from their place, in m RMS over the dish floor; nothing where too few of them are
  /// where they should be: something covers the dish, or the camera has moved further. How they look is
  /// learned from the first image in which they are seen. `image`: 8-bit BGR, of the calibration's size.
  std::optional<double> moved_m(const cv::Mat& image);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::imaging
