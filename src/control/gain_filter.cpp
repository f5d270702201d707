#include "lodestone/control/gain_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::control {
namespace {

constexpr int kSteps = 20;  // of the grid, to each side of 1

void normalise(std::vector<double>& weights) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= total;
}

}  // namespace

GainFilter::GainFilter(std::shared_ptr<const LearnedSimulator> model, const IdentificationConfig& config,
                       double drive_per_A)
    : model_(std::move(model)), config_(config), drive_per_A_(drive_per_A) {
  LODESTONE_CHECK(model_->sampled, "a simulator that predicts distributions");
  for (int k = -kSteps; k <= kSteps; ++k) log_gain_.push_back(k * std::log(kMostGain) / kSteps);
  reset();
}

void GainFilter::reset() {
  weight_.clear();
  for (const double gain : log_gain_) {
    const double z = gain / config_.prior_log_sigma;
    weight_.push_back(std::exp(-0.5 * z * z));
  }
  normalise(weight_);
}

void GainFilter::pulse(const geometry::Pose2& before, const geometry::Vector2& drive_A,
                       const geometry::Pose2& after) {
  if (drive_A.isZero(0.0)) return;
  const std::size_t size = model_->state_size;
  const std::size_t count = log_gain_.size();
  const double from[3] = {before.x_m, before.y_m, before.heading_rad};
  const double to[3] = {after.x_m, after.y_m, after.heading_rad};
  const double noise[3] = {config_.noise_m, config_.noise_m, config_.noise_rad};
  const double limit = model_->action.scale;
  state_.resize(count * size);
  seen_.resize(count * size);
  drive_.resize(2 * count);
  density_.resize(count);
  sum_.assign(count, 0.0);
  for (std::size_t g = 0; g < count; ++g) {
    std::copy_n(from, size, &state_[g * size]);
    std::copy_n(to, size, &seen_[g * size]);
    // No simulator knows what more than it was shown does.
    const geometry::Vector2 drive =
        (std::exp(log_gain_[g]) * drive_per_A_ * drive_A).cwiseMax(-limit).cwiseMin(limit);
    drive_[2 * g] = drive.x();
    drive_[2 * g + 1] = drive.y();
  }
  for (const inference::FoldedDynamics& member : model_->members) {
    member.log_density(state_.data(), drive_.data(), seen_.data(), noise, static_cast<std::int64_t>(count),
                       density_.data(), workspace_);
    for (std::size_t g = 0; g < count; ++g)
      sum_[g] += std::exp(density_[g]) / static_cast<double>(model_->members.size());
  }
  // An outlier lies anywhere in the dish.
  const double turns = size == 3 ? 2.0 * geometry::kPi : 1.0;
  const double outlier = 1.0 / (geometry::kPi * std::pow(model_->dish_radius_m, 2) * turns);
  for (std::size_t g = 0; g < count; ++g)
    weight_[g] *=
        std::pow((1.0 - config_.outlier_share) * sum_[g] / outlier + config_.outlier_share, config_.temper);
  normalise(weight_);
}

task::DriveGain GainFilter::gain() const {
  double mean = 0.0, square = 0.0;
  for (std::size_t g = 0; g < log_gain_.size(); ++g) {
    mean += weight_[g] * log_gain_[g];
    square += weight_[g] * log_gain_[g] * log_gain_[g];
  }
  return {mean, std::sqrt(std::max(0.0, square - mean * mean))};
}

}  // namespace lodestone::control
