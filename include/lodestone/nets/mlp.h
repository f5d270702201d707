#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <torch/nn/modules/linear.h>

#include "lodestone/common/random.h"

namespace lodestone::nets {

/// Linear layers sizes[0] -> sizes[1] -> ..., registered in `module` as l<first>, l<first + 1>, ...
std::vector<torch::nn::Linear> register_linear_layers(torch::nn::Module& module,
                                                      const std::vector<std::int64_t>& sizes, int first = 1);

/// ReLU after every layer but the last. [N, sizes.front()] -> [N, sizes.back()].
torch::Tensor forward_relu(std::vector<torch::nn::Linear>& layers, torch::Tensor x);

/// Draws every linear layer anew from `random` by PyTorch's default (weights and biases uniform within
/// 1 / sqrt(inputs)), so that a network depends on the run's seed alone, not on LibTorch's global generator.
void initialise_linear_layers(torch::nn::Module& module, common::RandomStream& random);

}  // namespace lodestone::nets
