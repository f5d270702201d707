#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/dish_view.h"
#include "lodestone/segmentation/frame_labels.h"

namespace lodestone::segmentation {

/// Images of one dish, made straight: whole views, 8-bit BGR, each with its name.
struct FrameViews {
  imaging::DishView view;
  std::vector<cv::Mat> images;
  std::vector<std::string> names;
};

/// Labels of images in which a needle moves, whatever it looks like: what differs from the median of all
/// images, where a rod of the needle's size explains it (vision::fit_rod gives the verdict). The head is the
/// end that looks other than the needle's middle, in all images together. Doubt is the share of the rod that
/// nothing supports, or how much less its ends differ than in most images.
FrameLabels propose_labels(const FrameViews& frames, const imaging::BenchGeometry& bench);

}  // namespace lodestone::segmentation
