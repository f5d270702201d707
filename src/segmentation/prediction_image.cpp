#include "prediction_image.h"

#include <opencv2/imgproc.hpp>

#include <ATen/TensorOperators.h>
#include <ATen/ops/stack.h>
#include <ATen/ops/zeros_like.h>

namespace lodestone::segmentation {

namespace {

cv::Mat to_bgr(const at::Tensor& chw) {
  const at::Tensor hwc = chw.permute({1, 2, 0}).contiguous();
  return cv::Mat(static_cast<int>(hwc.size(0)), static_cast<int>(hwc.size(1)), CV_8UC3,
                 hwc.data_ptr<std::uint8_t>())
      .clone();
}

/// Needle in red, tape in green, of [2, h, w] uint8.
cv::Mat to_colours(const at::Tensor& masks, cv::Size size) {
  const at::Tensor bgr = at::stack({at::zeros_like(masks[0]), masks[1], masks[0]});
  cv::Mat out;
  cv::resize(to_bgr(bgr), out, size, 0.0, 0.0, cv::INTER_NEAREST);
  return out;
}

}  // namespace

cv::Mat prediction_image(const at::Tensor& images, const at::Tensor& masks, const at::Tensor& probability) {
  std::vector<cv::Mat> rows;
  for (std::int64_t i = 0; i < images.size(0); ++i) {
    const cv::Mat image = to_bgr(images[i]);
    const at::Tensor predicted = (probability[i] * 255.0).clamp(0.0, 255.0).to(at::kByte);
    cv::Mat row;
    cv::hconcat(
        std::vector<cv::Mat>{image, to_colours(masks[i], image.size()), to_colours(predicted, image.size())},
        row);
    rows.push_back(row);
  }
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  return sheet;
}

}  // namespace lodestone::segmentation
