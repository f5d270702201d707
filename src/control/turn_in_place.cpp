#include "lodestone/control/turn_in_place.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

/// A turn smaller than this is none: twice what the heading varies by from image to image, and more.
constexpr double kTurned_deg = 2.0;

}  // namespace

TurnInPlace::TurnInPlace(std::unique_ptr<Controller> inner, const TurnConfig& config,
                         const physics::RigDescription& rig, double scale_A)
    : inner_(std::move(inner)), config_(config), scale_A_(scale_A), field_(rig) {}

void TurnInPlace::reset() {
  inner_->reset();
  arrived_ = false;
  turning_ = false;
}

geometry::Vector2 TurnInPlace::drive_along(double heading_rad, const geometry::Vector2& position_m) const {
  return unit_drive_along({std::cos(heading_rad), std::sin(heading_rad)}, [&](const geometry::Vector2& two) {
    return field_.at(field_.along(two, position_m), position_m).field_T;
  });
}

geometry::Drive TurnInPlace::act(const task::Observation& observation) {
  const geometry::Pose2& pose = observation.pose;
  const double turn_deg =
      geometry::kDegPerRad *
      geometry::wrap_angle(observation.target_heading_rad.value_or(pose.heading_rad) - pose.heading_rad);
  const double error_deg = std::abs(turn_deg);
  // Two bounds, as a needle moves a little while it turns, and a pull would undo the turn.
  const double distance_m = (observation.target_m - pose.position_m()).norm();
  const bool stays = observation.target_heading_rad && observation.ahead.empty();
  arrived_ = stays && distance_m <= (arrived_ ? config_.leave_m : config_.arrive_m);
  const bool good = error_deg <= config_.heading_deg;
  if (!arrived_ || good) turning_ = false;
  if (!arrived_) return inner_->act(observation);
  if (good) return observation.rest();
  const bool stuck = turning_ && last_error_deg_ - error_deg < kTurned_deg;
  current_A_ = stuck ? std::min(current_A_ * config_.growth, config_.max_current_A) : config_.current_A;
  turning_ = true;
  last_error_deg_ = error_deg;
  const double heading_rad =
      pose.heading_rad + std::clamp(turn_deg, -config_.lead_deg, config_.lead_deg) / geometry::kDegPerRad;
  const geometry::Vector2 action = drive_along(heading_rad, pose.position_m()) * (current_A_ / scale_A_);
  return geometry::saturated_in_direction(field_.along(action, pose.position_m()));
}

}  // namespace lodestone::control
