#include "lodestone/inference/mixture.h"

#include <algorithm>
#include <cmath>

namespace lodestone::inference {
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

}  // namespace lodestone::inference
