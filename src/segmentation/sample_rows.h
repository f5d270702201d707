#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "lodestone/segmentation/samples.h"

namespace lodestone::segmentation {

/// Puts an image, [crop, crop] 8-bit BGR, into a row of the samples.
void store_image(const cv::Mat& image, std::int64_t row, SegmenterSamples& samples);
/// Puts a mask, [crop, crop] 8 bit, shrunk to the samples' own size, into one channel of a row.
void store_mask(const cv::Mat& mask, std::int64_t row, std::int64_t channel, SegmenterSamples& samples);

}  // namespace lodestone::segmentation
