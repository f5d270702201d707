#include "lodestone/dynamics/mixture.h"

#include <ATen/TensorOperators.h>
#include <ATen/ops/log_softmax.h>
#include <ATen/ops/logsumexp.h>
#include <ATen/ops/sigmoid.h>
#include <ATen/ops/softmax.h>

namespace lodestone::dynamics {

at::Tensor mixture_loss(const at::Tensor& raw, const at::Tensor& target, const MixtureLayout& layout,
                        double mean_weight) {
  const std::int64_t rows = raw.size(0);
  const std::int64_t k = layout.components;
  const std::int64_t s = layout.size;
  const at::Tensor log_weight = at::log_softmax(raw.narrow(1, 0, k), 1);
  const at::Tensor mean = raw.narrow(1, k, k * s).reshape({rows, k, s});
  const at::Tensor log_spread =
      inference::kLeastLogSpread + (inference::kMostLogSpread - inference::kLeastLogSpread) *
                                       at::sigmoid(raw.narrow(1, k + k * s, k * s)).reshape({rows, k, s});
  const at::Tensor error = (target.unsqueeze(1) - mean) * (-log_spread).exp();
  const at::Tensor log_density = (-0.5 * error.square() - log_spread).sum(2);
  const at::Tensor unlikely = -at::logsumexp(log_weight + log_density, 1).mean() / static_cast<double>(s);
  if (mean_weight == 0.0) return unlikely;
  return unlikely + mean_weight * (mixture_mean(raw, layout) - target).square().mean();
}

at::Tensor mixture_mean(const at::Tensor& raw, const MixtureLayout& layout) {
  const std::int64_t k = layout.components;
  const at::Tensor weight = at::softmax(raw.narrow(1, 0, k), 1).unsqueeze(2);
  return (weight * raw.narrow(1, k, k * layout.size).reshape({raw.size(0), k, layout.size})).sum(1);
}

}  // namespace lodestone::dynamics
