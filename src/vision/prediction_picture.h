#pragma once

#include <opencv2/core/mat.hpp>

#include <torch/torch.h>

namespace lodestone::vision {

/// One row per picture: the picture, the true masks, the predicted ones (needle in red, tape in green).
/// pictures [N, 3, H, W] uint8 BGR, masks [>= N, 2, h, w] uint8, probability [N, 2, h, w] float32.
cv::Mat prediction_picture(const torch::Tensor& pictures, const torch::Tensor& masks,
                           const torch::Tensor& probability);

}  // namespace lodestone::vision
