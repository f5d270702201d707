#pragma once

#include <opencv2/core/mat.hpp>

#include <torch/torch.h>

namespace lodestone::vision {

/// One row per image: the image, the true masks, the predicted ones (needle in red, tape in green).
/// images [N, 3, H, W] uint8 BGR, masks [>= N, 2, h, w] uint8, probability [N, 2, h, w] float32.
cv::Mat prediction_image(const torch::Tensor& images, const torch::Tensor& masks,
                         const torch::Tensor& probability);

}  // namespace lodestone::vision
