#include "lodestone/inference/mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodestone/geometry/angle.h"

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
constexpr double kLeastWeight = 1e-30;  // of which a logarithm can be taken

}  // namespace

void mixture_weights(const float* raw, const MixtureLayout& layout, float* out) {
  const float sum = weights(raw, layout.components, out);
  for (std::int64_t k = 0; k < layout.components; ++k) out[k] /= sum;
}

double mixture_spread(float raw) {
  return std::exp(kLeastLogSpread +
                  (kMostLogSpread - kLeastLogSpread) / (1.0 + std::exp(-static_cast<double>(raw))));
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

Luck Luck::draw(std::int64_t size, common::RandomStream& random) {
  Luck luck;
  luck.uniform = random.uniform();
  for (std::int64_t i = 0; i < size; ++i) luck.normal[static_cast<std::size_t>(i)] = random.normal();
  return luck;
}

void mixture_draw(const float* raw, const MixtureLayout& layout, const Luck& luck, float* out) {
  float weight[kMostComponents];
  float left = static_cast<float>(luck.uniform) * weights(raw, layout.components, weight);
  std::int64_t chosen = 0;
  while (chosen + 1 < layout.components && left >= weight[chosen]) left -= weight[chosen++];
  const float* mean = raw + layout.components + chosen * layout.size;
  const float* spread = mean + layout.components * layout.size;
  for (std::int64_t i = 0; i < layout.size; ++i)
    out[i] =
        mean[i] + static_cast<float>(mixture_spread(spread[i]) * luck.normal[static_cast<std::size_t>(i)]);
}

double mixture_log_density(const float* raw, const MixtureLayout& layout, const double* value,
                           const double* noise) {
  float weight[kMostComponents];
  const double sum = static_cast<double>(weights(raw, layout.components, weight));
  double log_density[kMostComponents];
  double most = -std::numeric_limits<double>::infinity();
  const float* mean = raw + layout.components;
  const float* spread = mean + layout.components * layout.size;
  for (std::int64_t k = 0; k < layout.components; ++k) {
    log_density[k] = std::log(static_cast<double>(weight[k]) / sum + kLeastWeight);
    for (std::int64_t i = 0; i < layout.size; ++i) {
      const double own = mixture_spread(*spread++);
      const double variance = own * own + noise[i] * noise[i];
      const double error = value[i] - static_cast<double>(*mean++);
      log_density[k] -= 0.5 * (error * error / variance + std::log(2.0 * geometry::kPi * variance));
    }
    most = std::max(most, log_density[k]);
  }
  double total = 0.0;
  for (std::int64_t k = 0; k < layout.components; ++k) total += std::exp(log_density[k] - most);
  return most + std::log(total);
}

}  // namespace lodestone::inference
