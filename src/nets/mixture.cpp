#include "lodestone/nets/mixture.h"

#include <torch/types.h>

namespace lodestone::nets {

torch::Tensor mixture_loss(const torch::Tensor& raw, const torch::Tensor& target,
                           const MixtureLayout& layout) {
  const std::int64_t rows = raw.size(0);
  const std::int64_t k = layout.components;
  const std::int64_t s = layout.size;
  const torch::Tensor log_weight = torch::log_softmax(raw.narrow(1, 0, k), 1);
  const torch::Tensor mean = raw.narrow(1, k, k * s).reshape({rows, k, s});
  const torch::Tensor log_spread =
      inference::kLeastLogSpread + (inference::kMostLogSpread - inference::kLeastLogSpread) *
                                       torch::sigmoid(raw.narrow(1, k + k * s, k * s)).reshape({rows, k, s});
  const torch::Tensor error = (target.unsqueeze(1) - mean) * torch::exp(-log_spread);
  const torch::Tensor log_density = (-0.5 * error.square() - log_spread).sum(2);
  return -torch::logsumexp(log_weight + log_density, 1).mean() / static_cast<double>(s);
}

torch::Tensor mixture_mean(const torch::Tensor& raw, const MixtureLayout& layout) {
  const std::int64_t k = layout.components;
  const torch::Tensor weight = torch::softmax(raw.narrow(1, 0, k), 1).unsqueeze(2);
  return (weight * raw.narrow(1, k, k * layout.size).reshape({raw.size(0), k, layout.size})).sum(1);
}

}  // namespace lodestone::nets
