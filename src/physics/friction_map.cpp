#include "lodestone/physics/friction_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"

namespace lodestone::physics {
namespace {

constexpr double kSpacing_m = 1e-3;

}  // namespace

void FrictionConfig::validate() const {
  if (kinetic_coefficient > static_coefficient)
    throw common::InvalidConfig("kinetic_coefficient", kinetic_coefficient,
                                fmt::format("not exceed static_coefficient = {}", static_coefficient));
}

FrictionMap::FrictionMap(const FrictionConfig& config, double reach_m, std::uint64_t seed)
    : reach_m_(reach_m) {
  if (config.map_sigma == 0.0) return;
  const int half = static_cast<int>(std::ceil(reach_m / kSpacing_m));
  nodes_ = 2 * half + 1;
  reach_m_ = half * kSpacing_m;
  // White noise smoothed by exp(-r^2 / l^2) has the covariance exp(-r^2 / (2 l^2)).
  const double length = config.map_correlation_m / kSpacing_m;
  const int radius = static_cast<int>(std::ceil(3.5 * length));
  std::vector<double> kernel(2 * radius + 1);
  double squares = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    kernel[i + radius] = std::exp(-(i * i) / (length * length));
    squares += kernel[i + radius] * kernel[i + radius];
  }
  for (double& weight : kernel) weight /= std::sqrt(squares);

  const int wide = nodes_ + 2 * radius;
  common::RandomStream random(seed, "friction_map");
  std::vector<double> noise(static_cast<std::size_t>(wide) * wide);
  for (double& value : noise) value = random.normal();
  std::vector<double> along(static_cast<std::size_t>(wide) * nodes_, 0.0);
  for (int i = 0; i < wide; ++i) {
    for (int j = 0; j < nodes_; ++j) {
      for (int k = 0; k < 2 * radius + 1; ++k) along[i * nodes_ + j] += kernel[k] * noise[i * wide + j + k];
    }
  }
  factor_.resize(static_cast<std::size_t>(nodes_) * nodes_);
  const double sigma = config.map_sigma;
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < nodes_; ++j) {
      double g = 0.0;
      for (int k = 0; k < 2 * radius + 1; ++k) g += kernel[k] * along[(i + k) * nodes_ + j];
      factor_[i * nodes_ + j] = static_cast<float>(std::exp(sigma * g - 0.5 * sigma * sigma));
    }
  }
}

double FrictionMap::factor(double x_m, double y_m) const {
  if (nodes_ == 0) return 1.0;
  const double last = nodes_ - 1.000001;
  const double u = std::clamp((x_m + reach_m_) / kSpacing_m, 0.0, last);
  const double v = std::clamp((y_m + reach_m_) / kSpacing_m, 0.0, last);
  const int i = static_cast<int>(u);
  const int j = static_cast<int>(v);
  const double s = u - i;
  const double t = v - j;
  const float* near = &factor_[static_cast<std::size_t>(i) * nodes_ + j];
  const float* far = near + nodes_;
  return (1.0 - s) * ((1.0 - t) * near[0] + t * near[1]) + s * ((1.0 - t) * far[0] + t * far[1]);
}

}  // namespace lodestone::physics
