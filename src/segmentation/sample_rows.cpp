#include "sample_rows.h"

#include <opencv2/imgproc.hpp>

#include <ATen/TensorOperators.h>
#include <ATen/ops/from_blob.h>

namespace lodestone::segmentation {

void store_image(const cv::Mat& image, std::int64_t row, SegmenterSamples& samples) {
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  const at::Tensor pixels =
      at::from_blob(whole.data, {whole.rows, whole.cols, 3}, at::kByte).permute({2, 0, 1});
  samples.images[row].copy_(pixels);
}

void store_mask(const cv::Mat& mask, std::int64_t row, std::int64_t channel, SegmenterSamples& samples) {
  const auto side = static_cast<int>(samples.masks.size(2));
  cv::Mat small;
  cv::resize(mask, small, {side, side}, 0.0, 0.0, cv::INTER_AREA);
  samples.masks[row][channel].copy_(at::from_blob(small.data, {side, side}, at::kByte));
}

}  // namespace lodestone::segmentation
