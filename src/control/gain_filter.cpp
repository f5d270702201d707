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

GainFilter::GainFilter(MotionModel model, const IdentificationConfig& config)
    : config_(config), model_(std::move(model)) {
  for (int k = -kSteps; k <= kSteps; ++k) factor_.push_back(std::pow(kMostGain, 1.0 * k / kSteps));
  reset();
}

void GainFilter::reset() {
  weight_.clear();
  for (const double factor : factor_) {
    const double z = std::log(factor) / config_.prior_log_sigma;
    weight_.push_back(std::exp(-0.5 * z * z));
  }
  normalise(weight_);
  stalled_.clear();
}

void GainFilter::learn(const SeenPulse& pulse) {
  if (pulse.drive_A.isZero(0.0)) return;
  imagined_.clear();
  for (const double factor : factor_)
    imagined_.push_back({pulse.before, factor * pulse.drive_A, pulse.after});
  model_.judge(imagined_, says_);
  const double most = *std::max_element(says_.begin(), says_.end());
  for (double& ratio : says_) ratio = std::pow(ratio / most, config_.temper);
  if (!still(pulse.before)) {
    place_ = pulse.before;
    stalled_.clear();
  }
  if (!still(pulse.after)) {
    for (std::size_t k = 0; k < weight_.size(); ++k) weight_[k] *= says_[k];
  } else {
    // The same friction held the needle each time: what one of these pulses said, another cannot say again.
    if (stalled_.empty()) stalled_.assign(weight_.size(), 1.0);
    for (std::size_t k = 0; k < weight_.size(); ++k) {
      const double least = std::min(stalled_[k], says_[k]);
      weight_[k] *= least / stalled_[k];
      stalled_[k] = least;
    }
  }
  normalise(weight_);
}

bool GainFilter::still(const geometry::Pose2& pose) const {
  const double turned_rad = geometry::wrap_angle(pose.heading_rad - place_.heading_rad);
  return (pose.position_m() - place_.position_m()).norm() < config_.noise_m &&
         std::abs(turned_rad) < config_.noise_rad;
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

common::Json GainFilter::save() const {
  return {
      {"weight", weight_}, {"place", {place_.x_m, place_.y_m, place_.heading_rad}}, {"stalled", stalled_}};
}

void GainFilter::restore(const common::Json& state) {
  try {
    auto weight = state.at("weight").get<std::vector<double>>();
    auto stalled = state.at("stalled").get<std::vector<double>>();
    const common::Json& place = state.at("place");
    if (weight.size() != factor_.size() || (!stalled.empty() && stalled.size() != factor_.size()))
      throw common::DataError("identification state: it is of another grid of gains");
    place_ = {place.at(0).get<double>(), place.at(1).get<double>(), place.at(2).get<double>()};
    weight_ = std::move(weight);
    stalled_ = std::move(stalled);
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("identification state is malformed: ") + error.what());
  }
}

}  // namespace lodestone::control
