#include "lodestone/control/drift_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "lodestone/geometry/angle.h"

namespace lodestone::control {
namespace {

using Basis = Eigen::Matrix<double, 2, 6>;

/// Of the drifts looked for: up to two a second, as far apart as some ten seconds can tell.
constexpr int kFrequencies = 160;
constexpr double kFrequencyStep_Hz = 0.0125;
/// What is believed before any pulse, beside rest: as much of a drift that stays as of all that pulse.
constexpr double kSteadyShare = 0.5;
/// Elsewhere a needle is carried otherwise: by so much more after a second.
constexpr double kChange_m = 1e-4;
/// How long a pulse lets a needle slide, and so be carried, differs by this share.
constexpr double kUneven = 0.4;
/// Poses are seen as well as this.
constexpr double kSeen_m = 1e-4;
/// No explanation is given up for good,
constexpr double kLeastWeight = 1e-6;
/// and no pulse says more than this (logarithm) against one.
constexpr double kMostEvidence = 8.0;
/// Predictions that hardly ever move a needle say nothing of one that moved.
constexpr double kLeastMoving = 0.05;

/// What of a flow carries a needle that lies so: all of it across, half of it along.
Eigen::Matrix2d carries(double heading_rad) {
  constexpr double kAlong = 0.5;
  const geometry::Vector2 along(std::cos(heading_rad), std::sin(heading_rad));
  return Eigen::Matrix2d::Identity() - (1.0 - kAlong) * along * along.transpose();
}

double heading_between_rad(const geometry::Pose2& from, const geometry::Pose2& to) {
  return from.heading_rad + 0.5 * geometry::wrap_angle(to.heading_rad - from.heading_rad);
}

/// Where a needle is predicted to come to, should it move: the mean, and the variance of each coordinate.
struct Moving {
  geometry::Vector2 mean_m;
  double variance_m2;
};

bool moved(const geometry::Pose2& before, const geometry::Pose2& after, const IdentificationConfig& config) {
  return (after.position_m() - before.position_m()).norm() >= config.noise_m ||
         std::abs(geometry::wrap_angle(after.heading_rad - before.heading_rad)) >= config.noise_rad;
}

std::optional<Moving> where_it_moves(const geometry::Pose2& before,
                                     const std::vector<physics::PulseOutcome>& predicted,
                                     const IdentificationConfig& config) {
  double weight = 0.0, square_m2 = 0.0;
  geometry::Vector2 sum_m = geometry::Vector2::Zero();
  for (const physics::PulseOutcome& one : predicted) {
    if (!moved(before, one.mean, config)) continue;
    const geometry::Vector2 to_m = one.mean.position_m() - before.position_m();
    weight += one.weight;
    sum_m += one.weight * to_m;
    square_m2 +=
        one.weight * (to_m.squaredNorm() + one.sigma_x_m * one.sigma_x_m + one.sigma_y_m * one.sigma_y_m);
  }
  if (weight < kLeastMoving) return std::nullopt;
  const geometry::Vector2 mean_m = sum_m / weight;
  const double variance_m2 = 0.5 * std::max(0.0, square_m2 / weight - mean_m.squaredNorm());
  return Moving{before.position_m() + mean_m, variance_m2};
}

/// Takes the numbers of a wave to the drift at a time.
Basis basis(double frequency_Hz, double time_s) {
  const double angle_rad = 2.0 * geometry::kPi * frequency_Hz * time_s;
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  Basis numbers;
  numbers << one, std::cos(angle_rad) * one, std::sin(angle_rad) * one;
  return numbers;
}

/// Logarithm of a normal density, but for a constant.
double log_density(const geometry::Vector2& off_m, const Eigen::Matrix2d& variance_m2) {
  return -0.5 * std::log(variance_m2.determinant()) - 0.5 * off_m.dot(variance_m2.inverse() * off_m);
}

}  // namespace

geometry::Vector2 carried_m(const geometry::Vector2& across_m, const geometry::Pose2& from,
                            const geometry::Pose2& to) {
  return carries(heading_between_rad(from, to)) * across_m;
}

DriftFilter::DriftFilter(const IdentificationConfig& config) : config_(config) { reset(); }

void DriftFilter::reset() {
  waves_.clear();
  rest_weight_ = 1.0;
  learned_s_ = 0.0;
  if (config_.drift_m <= 0.0) return;
  rest_weight_ = 1.0 - config_.drift_share;
  const double variance_m2 = config_.drift_m * config_.drift_m;
  for (int k = 0; k <= kFrequencies; ++k) {
    Wave& wave = waves_.emplace_back();
    wave.frequency_Hz = kFrequencyStep_Hz * k;
    wave.weight = config_.drift_share * (k == 0 ? kSteadyShare : (1.0 - kSteadyShare) / kFrequencies);
    const double wave_m2 = k == 0 ? 0.0 : 0.5 * variance_m2;
    wave.variance_m2.diagonal() << variance_m2, variance_m2, wave_m2, wave_m2, wave_m2, wave_m2;
  }
}

void DriftFilter::learn(const SeenPulse& pulse, const std::vector<physics::PulseOutcome>& predicted,
                        double log_gain_sigma) {
  if (waves_.empty() || pulse.drive_A.isZero(0.0) || !moved(pulse.before, pulse.after, config_)) return;
  const std::optional<Moving> moving = where_it_moves(pulse.before, predicted, config_);
  if (!moving) return;
  const double by_gain_m = log_gain_sigma * (moving->mean_m - pulse.before.position_m()).norm();
  const double noise_m2 = moving->variance_m2 + by_gain_m * by_gain_m + kSeen_m * kSeen_m;
  const geometry::Vector2 left_m = pulse.after.position_m() - moving->mean_m;
  const double changes_m2 = kChange_m * kChange_m * std::max(0.0, pulse.began_s - learned_s_);
  learned_s_ = pulse.began_s;
  const Eigen::Matrix2d carried = carries(heading_between_rad(pulse.before, pulse.after));
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  const double at_rest = log_density(left_m, noise_m2 * one);
  double most = at_rest;
  for (Wave& wave : waves_) {
    wave.variance_m2.diagonal().head(wave.frequency_Hz > 0.0 ? 6 : 2).array() += changes_m2;
    const Basis h = carried * basis(wave.frequency_Hz, pulse.began_s);
    const geometry::Vector2 drift_m = h * wave.mean_m;
    const geometry::Vector2 off_m = left_m - drift_m;
    const Eigen::Matrix<double, 6, 2> ph = wave.variance_m2 * h.transpose();
    const double uneven_m2 = 0.5 * kUneven * kUneven * drift_m.squaredNorm();
    const Eigen::Matrix2d off_m2 = h * ph + (noise_m2 + uneven_m2) * one;
    const Eigen::Matrix<double, 6, 2> gain = ph * off_m2.inverse();
    wave.evidence = log_density(off_m, off_m2);
    wave.mean_m += gain * off_m;
    wave.variance_m2 -= gain * ph.transpose();
    most = std::max(most, wave.evidence);
  }
  const auto said = [&](double evidence) {
    return std::exp(config_.temper * std::max(evidence - most, -kMostEvidence));
  };
  rest_weight_ *= said(at_rest);
  double total = rest_weight_;
  for (Wave& wave : waves_) total += wave.weight *= said(wave.evidence);
  rest_weight_ = std::max(kLeastWeight, rest_weight_ / total);
  for (Wave& wave : waves_)
    wave.weight = std::max(kLeastWeight / static_cast<double>(waves_.size()), wave.weight / total);
}

geometry::Vector2 DriftFilter::drift_m(double begins_s) const {
  geometry::Vector2 sum_m = geometry::Vector2::Zero();
  for (const Wave& wave : waves_) sum_m += wave.weight * (basis(wave.frequency_Hz, begins_s) * wave.mean_m);
  return sum_m;
}

std::vector<geometry::Vector2> DriftFilter::drifts_m(double begin_s, double period_s,
                                                     std::size_t pulses) const {
  std::vector<geometry::Vector2> drifts;
  if (flow_probability() < 0.5) return drifts;
  for (std::size_t k = 0; k < pulses; ++k)
    drifts.push_back(drift_m(begin_s + period_s * static_cast<double>(k)));
  return drifts;
}

geometry::Vector2 DriftFilter::by_flow_m(const SeenPulse& pulse) const {
  if (flow_probability() < 0.5 || !moved(pulse.before, pulse.after, config_))
    return geometry::Vector2::Zero();
  return carried_m(drift_m(pulse.began_s), pulse.before, pulse.after);
}

}  // namespace lodestone::control
