#pragma once

#include <opencv2/core/mat.hpp>

namespace lodestone::imaging {

/// One image: 8-bit BGR, rows from the top, with the time of the middle of its exposure on the rig's clock.
struct Frame {
  cv::Mat image;
  double stamp_s = 0.0;
};

}  // namespace lodestone::imaging
