#include "lodestone/nets/mlp.h"

#include <cmath>

namespace lodestone::nets {

std::vector<torch::nn::Linear> register_linear_layers(torch::nn::Module& module,
                                                      const std::vector<std::int64_t>& sizes, int first) {
  std::vector<torch::nn::Linear> layers;
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) {
    layers.push_back(module.register_module("l" + std::to_string(first + static_cast<int>(i)),
                                            torch::nn::Linear(sizes[i], sizes[i + 1])));
  }
  return layers;
}

torch::Tensor forward_relu(std::vector<torch::nn::Linear>& layers, torch::Tensor x) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    x = layers[i]->forward(x);
    if (i + 1 < layers.size()) x = torch::relu(x);
  }
  return x;
}

void initialise_linear_layers(torch::nn::Module& module, common::RandomStream& random) {
  const torch::NoGradGuard no_grad;
  for (const auto& child : module.modules()) {
    auto* linear = child->as<torch::nn::Linear>();
    if (linear == nullptr) continue;
    const double bound = 1.0 / std::sqrt(static_cast<double>(linear->weight.size(1)));
    for (torch::Tensor* tensor : {&linear->weight, &linear->bias}) {
      torch::Tensor values = torch::empty(tensor->sizes(), torch::kFloat64);
      double* data = values.data_ptr<double>();
      for (std::int64_t i = 0; i < values.numel(); ++i) data[i] = random.uniform(-bound, bound);
      tensor->copy_(values);
    }
  }
}

}  // namespace lodestone::nets
