#include "lodestone/nets/mixture.h"

#include <algorithm>
#include <cmath>

namespace lodestone::nets {
namespace {

/// Weights of the components before they are normalised, largest 1; returns their sum.
float weights(const float* raw, std::int64_t components, float* out) {
  const float most = *std::max_element(raw, raw + components);
  float sum = 0.0F;
  for (std::int64_t k = 0; k < components; ++k) sum += out[k] = std::exp(raw[k] - most);
  return sum;
}

constexpr std::int64_t kMostComponents = 16;

}  // namespace

torch::Tensor mixture_loss(const torch::Tensor& raw, const torch::Tensor& target,
                           const MixtureLayout& layout) {
  const std::int64_t rows = raw.size(0);
  const std::int64_t k = layout.components;
  const std::int64_t s = layout.size;
  const torch::Tensor log_weight = torch::log_softmax(raw.narrow(1, 0, k), 1);
  const torch::Tensor mean = raw.narrow(1, k, k * s).reshape({rows, k, s});
  const torch::Tensor log_spread =
      kLeastLogSpread + (kMostLogSpread - kLeastLogSpread) *
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

void mixture_mean(const float* raw, const MixtureLayout& layout, float* out) {
  float weight[kMostComponents];
  const float sum = weights(raw, layout.components, weight);
  const float* mean = raw + layout.components;
  std::fill_n(out, layout.size, 0.0F);
  for (std::int64_t k = 0; k < layout.components; ++k) {
    for (std::int64_t i = 0; i < layout.size; ++i) out[i] += weight[k] / sum * *mean++;
  }
}

void mixture_draw(const float* raw, const MixtureLayout& layout, common::RandomStream& random, float* out) {
  float weight[kMostComponents];
  float left = static_cast<float>(random.uniform()) * weights(raw, layout.components, weight);
  std::int64_t chosen = 0;
  while (chosen + 1 < layout.components && left >= weight[chosen]) left -= weight[chosen++];
  const float* mean = raw + layout.components + chosen * layout.size;
  const float* spread = mean + layout.components * layout.size;
  for (std::int64_t i = 0; i < layout.size; ++i) {
    const double log_spread = kLeastLogSpread + (kMostLogSpread - kLeastLogSpread) /
                                                    (1.0 + std::exp(-static_cast<double>(spread[i])));
    out[i] = mean[i] + static_cast<float>(std::exp(log_spread) * random.normal());
  }
}

}  // namespace lodestone::nets
