#include "lodestone/control/decorators.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {

namespace {
// Friction differs from pulse to pulse: what did not move may yet.
constexpr int kStallsBeforeDither = 2;
// A way is straight while the bee line is at least so much of it: a gentle bend is, a corner is not.
constexpr double kStraight = 0.95;

/// The farthest point of the way ahead, at most `lead_s` from now, to which that way is straight; with the
/// heading of the step that it lies in.
task::TargetAhead straight_ahead(const task::Observation& observation, double lead_s) {
  task::TargetAhead farthest{observation.target_m, 0.0, observation.target_heading_rad};
  geometry::Vector2 last_m = observation.target_m;
  double last_s = 0.0;
  double way_m = 0.0;
  for (const task::TargetAhead& next : observation.ahead) {
    const double share = std::min(1.0, (lead_s - last_s) / (next.in_s - last_s));
    const geometry::Vector2 point_m = last_m + share * (next.point_m - last_m);
    way_m += (point_m - last_m).norm();
    if ((point_m - observation.target_m).norm() < kStraight * way_m) break;
    farthest = {point_m, last_s + share * (next.in_s - last_s),
                next.heading_rad ? next.heading_rad : observation.target_heading_rad};
    if (next.in_s >= lead_s) break;
    last_m = next.point_m;
    last_s = next.in_s;
  }
  return farthest;
}
}  // namespace

AdaptiveGain::AdaptiveGain(std::unique_ptr<Controller> inner, const DecoratorConfig& config,
                           const physics::CoilDrive& drive)
    : inner_(std::move(inner)), config_(config), drive_(drive) {}

/// To one side, to the other, twice as far to the first, and so on up to a right angle.
geometry::Drive AdaptiveGain::dithered(const geometry::Drive& action) const {
  const int sides = full_stalls_ - kStallsBeforeDither;
  const double turns = 0.5 * (sides + 1);
  const double size_deg = std::min(std::floor(turns) * config_.direction_dither_deg, 90.0);
  const double angle_rad = (sides % 2 == 1 ? 1.0 : -1.0) * size_deg / geometry::kDegPerRad;
  // A dithered form of the full command is a full command.
  const geometry::Drive turned = drive_.turned(action, angle_rad);
  return turned / turned.cwiseAbs().maxCoeff();
}

void AdaptiveGain::reset() {
  inner_->reset();
  gain_ = 1.0;
  full_stalls_ = 0;
  full_ = false;
  acted_ = false;
}

geometry::Drive AdaptiveGain::act(const task::Observation& observation) {
  // A rest (hold, or no valid pose) in between says nothing about stalling.
  const bool driven = acted_ && !observation.last_action.isZero();
  if (driven) {
    const double turn_deg =
        geometry::kDegPerRad *
        std::abs(geometry::wrap_angle(observation.pose.heading_rad - last_pose_.heading_rad));
    const bool moved = observation.last_displacement_m.norm() >= config_.stall_threshold_m ||
                       turn_deg >= config_.stall_threshold_deg;
    gain_ = moved ? 1.0 : std::min(gain_ * config_.stall_gain, config_.stall_gain_max);
    full_stalls_ = moved || !full_ ? 0 : full_stalls_ + 1;
  }
  acted_ = true;
  last_pose_ = observation.pose;
  geometry::Drive action = gain_ * inner_->act(observation);
  const bool dither = full_stalls_ > kStallsBeforeDither && config_.direction_dither_deg > 0.0;
  if (dither) action = dithered(action);
  full_ = action.cwiseAbs().maxCoeff() >= 1.0;
  if (dither) action *= config_.direction_dither_fraction;
  // Scaled as a whole, so that the direction of the pull survives the limit.
  return geometry::saturated_in_direction(action);
}

geometry::Drive Hold::act(const task::Observation& observation) {
  const bool near = (observation.target_m - observation.pose.position_m()).norm() <= config_.hold_radius_m;
  const double heading_rad = observation.pose.heading_rad;
  const double turn_rad =
      geometry::wrap_angle(observation.target_heading_rad.value_or(heading_rad) - heading_rad);
  if (near && geometry::kDegPerRad * std::abs(turn_rad) <= config_.hold_heading_deg)
    return observation.rest();
  return inner_->act(observation);
}

geometry::Drive Lead::act(const task::Observation& observation) {
  task::Observation led = observation;
  const task::TargetAhead there = straight_ahead(observation, lead_s_);
  led.target_m = there.point_m;
  led.target_heading_rad = there.heading_rad;
  led.ahead.clear();
  return inner_->act(led);
}

std::unique_ptr<Controller> decorate(std::unique_ptr<Controller> controller, const DecoratorConfig& config,
                                     const physics::CoilDrive& drive) {
  if (config.stall_gain > 1.0)
    controller = std::make_unique<AdaptiveGain>(std::move(controller), config, drive);
  if (config.hold_radius_m > 0.0) controller = std::make_unique<Hold>(std::move(controller), config);
  if (config.lead_s > 0.0) controller = std::make_unique<Lead>(std::move(controller), config);
  return controller;
}

}  // namespace lodestone::control
