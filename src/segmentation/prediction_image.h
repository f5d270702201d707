#pragma once

#include <opencv2/core/mat.hpp>

#include <ATen/core/Tensor.h>

namespace lodestone::segmentation {

/// One row per image: the image, the true masks, the predicted ones (needle in red, tape in green).
/// images [N, 3, H, W] uint8 BGR, masks [>= N, 2, h, w] uint8, probability [N, 2, h, w] float32.
cv::Mat prediction_image(const at::Tensor& images, const at::Tensor& masks, const at::Tensor& probability);

}  // namespace lodestone::segmentation
