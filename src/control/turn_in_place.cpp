#include "lodestone/control/turn_in_place.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/task/action.h"

namespace lodestone::control {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegPerRad = 180.0 / kPi;
/// A turn smaller than this is none: twice what the heading varies by from picture to picture, and more.
constexpr double kTurned_deg = 2.0;

}  // namespace

TurnInPlace::TurnInPlace(std::unique_ptr<Controller> inner, const TurnConfig& config, double scale_A)
    : inner_(std::move(inner)), config_(config), scale_A_(scale_A) {
  for (int coil = 0; coil < 4; ++coil) coils_.emplace_back(config.coil, coil);
}

void TurnInPlace::reset() {
  inner_->reset();
  arrived_ = false;
  turning_ = false;
}

geometry::Vector2 TurnInPlace::field_T(const geometry::Vector2& axis_drive_A,
                                       const geometry::Vector2& position_m) const {
  const auto current_A = task::coil_currents(axis_drive_A);
  physics::FieldGradient at;
  for (std::size_t coil = 0; coil < coils_.size(); ++coil) {
    if (current_A[coil] != 0.0) coils_[coil].add(current_A[coil], position_m, at);
  }
  return at.field_T;
}

geometry::Vector2 TurnInPlace::drive_along(double heading_rad, const geometry::Vector2& position_m) const {
  const geometry::Vector2 wanted(std::cos(heading_rad), std::sin(heading_rad));
  double best_angle = 0.0;
  double best_cosine = -2.0;
  const auto try_angle = [&](double angle) {
    const geometry::Vector2 field = field_T({std::cos(angle), std::sin(angle)}, position_m);
    const double cosine = field.norm() > 0.0 ? field.dot(wanted) / field.norm() : -1.0;
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best_angle = angle;
    }
  };
  constexpr int kCoarse = 72;
  for (int i = 0; i < kCoarse; ++i) try_angle(2.0 * kPi * i / kCoarse);
  for (double step = kPi / kCoarse; step > 1e-3; step /= 2.0) {
    const double centre = best_angle;
    try_angle(centre - step);
    try_angle(centre + step);
  }
  return {std::cos(best_angle), std::sin(best_angle)};
}

geometry::Vector2 TurnInPlace::act(const task::Observation& observation) {
  const geometry::Pose2& pose = observation.pose;
  const double turn_deg =
      kDegPerRad *
      geometry::wrap_angle(observation.target_heading_rad.value_or(pose.heading_rad) - pose.heading_rad);
  const double error_deg = std::abs(turn_deg);
  // Two bounds, as a needle moves a little while it turns, and a pull would undo the turn.
  const double distance_m = (observation.target_m - pose.position_m()).norm();
  arrived_ = observation.target_heading_rad && distance_m <= (arrived_ ? config_.leave_m : config_.arrive_m);
  const bool good = error_deg <= config_.heading_deg;
  if (!arrived_ || good) turning_ = false;
  if (!arrived_) return inner_->act(observation);
  if (good) return geometry::Vector2::Zero();
  const bool stuck = turning_ && last_error_deg_ - error_deg < kTurned_deg;
  current_A_ = stuck ? std::min(current_A_ * config_.growth, config_.max_current_A) : config_.current_A;
  turning_ = true;
  last_error_deg_ = error_deg;
  const double heading_rad =
      pose.heading_rad + std::clamp(turn_deg, -config_.lead_deg, config_.lead_deg) / kDegPerRad;
  const geometry::Vector2 action = drive_along(heading_rad, pose.position_m()) * (current_A_ / scale_A_);
  return action / std::max(1.0, action.cwiseAbs().maxCoeff());
}

}  // namespace lodestone::control
