#include "lodestone/control/gain_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::control {
namespace {

void normalise(std::vector<double>& weights) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= total;
}

bool same(const geometry::Pose2& a, const geometry::Pose2& b) {
  return a.x_m == b.x_m && a.y_m == b.y_m && a.heading_rad == b.heading_rad;
}

}  // namespace

GainFilter::GainFilter(MotionModel model, const IdentificationConfig& config)
    : config_(config), model_(std::move(model)) {
  for (int k = -kSteps; k <= kSteps; ++k) factor_.push_back(std::pow(kMostGain, 1.0 * k / kSteps));
  if (config_.place_sigma > 0.0)
    for (std::size_t k = 0; k < factor_.size(); ++k) {
      const double z = static_cast<double>(k) * std::log(kMostGain) / kSteps / config_.place_sigma;
      kernel_.push_back(std::exp(-0.5 * z * z));
    }
  reset();
}

void GainFilter::reset() {
  weight_.clear();
  for (const double factor : factor_) {
    const double z = std::log(factor) / config_.prior_log_sigma;
    weight_.push_back(std::exp(-0.5 * z * z));
  }
  normalise(weight_);
}

void GainFilter::expect(const geometry::Pose2& before, const geometry::Drive& drive_A) {
  expected_A_.reset();
  if (drive_A.isZero(0.0)) return;
  imagined_.clear();
  for (const double factor : factor_) imagined_.push_back(factor * drive_A);
  model_.predict(before, imagined_, predicted_);
  expected_A_ = drive_A;
}

void GainFilter::learn(const SeenPulse& pulse) {
  if (pulse.drive_A.isZero(0.0)) return;
  if (!expected_A_ || expected_A_->size() != pulse.drive_A.size() || *expected_A_ != pulse.drive_A ||
      !same(predicted_.before, pulse.before))
    expect(pulse.before, pulse.drive_A);
  expected_A_.reset();
  model_.judge(predicted_, pulse.after, says_);
  const double most = *std::max_element(says_.begin(), says_.end());
  for (std::size_t k = 0; k < weight_.size(); ++k) weight_[k] *= std::pow(says_[k] / most, config_.temper);
  normalise(weight_);
  const double turned_rad = geometry::wrap_angle(pulse.after.heading_rad - pulse.before.heading_rad);
  const bool still = (pulse.after.position_m() - pulse.before.position_m()).norm() < config_.noise_m &&
                     std::abs(turned_rad) < config_.noise_rad;
  if (!still) move_on();
}

void GainFilter::move_on() {
  if (kernel_.empty()) return;
  const std::vector<double> before = weight_;
  for (std::size_t k = 0; k < weight_.size(); ++k) {
    weight_[k] = 0.0;
    for (std::size_t j = 0; j < before.size(); ++j) weight_[k] += before[j] * kernel_[k > j ? k - j : j - k];
  }
  normalise(weight_);
}

std::vector<physics::PulseOutcome> GainFilter::outcomes(const geometry::Pose2& before,
                                                        const geometry::Drive& drive_A) {
  return model_.outcomes(before, std::exp(gain().log_mean) * drive_A);
}

task::DriveGain GainFilter::gain() const {
  double mean = 0.0, square = 0.0;
  for (std::size_t k = 0; k < factor_.size(); ++k) {
    const double log_factor = std::log(factor_[k]);
    mean += weight_[k] * log_factor;
    square += weight_[k] * log_factor * log_factor;
  }
  return {mean, std::sqrt(std::max(0.0, square - mean * mean))};
}

common::Json GainFilter::save() const { return weight_; }

void GainFilter::restore(const common::Json& state) {
  std::vector<double> weight;
  try {
    weight = state.get<std::vector<double>>();
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("identification state is malformed: ") + error.what());
  }
  if (weight.size() != factor_.size())
    throw common::DataError("identification state: it is of another grid of gains");
  weight_ = std::move(weight);
}

}  // namespace lodestone::control
