#include "lodestone/control/observer_controller.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

constexpr double kSamePlace_m = 1e-6;
constexpr double kShortestMotion_m = 0.2e-3;  // a pulse that is to do less is not worth one
// Directions of the search: this far apart to each side of the wanted one, then halved three times.
constexpr double kFanStep_rad = 20.0 * geometry::kRadPerDeg;
constexpr int kFanSide = 5;    // steps; pull and drive differ by less than a right angle
constexpr int kFanAround = 9;  // all around, where a field may have to turn the needle elsewhere
constexpr int kFanHalvings = 3;
// Strengths of it: a part of the full action, to one per cent.
constexpr double kWeakestPart = 0.005;
constexpr int kPartHalvings = 9;
// Parts of a pulse that moves the needle which turn it alone: that takes less.
constexpr double kTurningParts[] = {0.25, 0.5, 0.75};

double turn_between_rad(double from_rad, double to_rad) {
  return std::abs(geometry::wrap_angle(to_rad - from_rad));
}

}  // namespace

ObserverController::ObserverController(const physics::RigDescription& rig, const ObserverConfig& config,
                                       double pulse_s, double rest_s)
    : config_(config),
      model_(std::make_shared<const PulseModel>(rig, pulse_s, rest_s)),
      observer_(model_, config),
      scale_A_(rig.coils.max_current_A) {}

void ObserverController::reset() {
  observer_.reset();
  growth_ = 1.0;
  seen_.reset();
  drove_ = false;
}

geometry::Drive ObserverController::act(const task::Observation& observation) {
  observe(observation);
  const geometry::Drive action = geometry::saturated_in_direction(growth_ * decide(observation));
  seen_ = observation.pose;
  drove_ = !action.isZero(0.0);
  return action;
}

void ObserverController::observe(const task::Observation& observation) {
  if (!seen_) return;
  const geometry::Drive& given = observation.last_action;  // whatever came between: decorators, limits
  const geometry::Vector2& moved_m = observation.last_displacement_m;
  const bool driven = !given.isZero(0.0);
  // Somebody else has driven since: how the needle lay then is not known.
  const geometry::Vector2 before_m = observation.pose.position_m() - moved_m;
  if (driven != drove_ || (before_m - seen_->position_m()).norm() > kSamePlace_m) return;
  observer_.learn(*seen_, scale_A_ * given, moved_m);
  if (!driven) return;
  const bool turned = turn_between_rad(seen_->heading_rad, observation.pose.heading_rad) >=
                      config_.still_deg * geometry::kRadPerDeg;
  if (turned || !observer_.stuck(moved_m))
    growth_ = 1.0;
  else if (given.cwiseAbs().maxCoeff() < 1.0)  // no further than the full drive
    growth_ *= config_.stuck_growth;
}

geometry::Drive ObserverController::decide(const task::Observation& observation) const {
  const geometry::Pose2& pose = observation.pose;
  const bool moves = !observation.ahead.empty();
  std::optional<double> heading_rad = observation.target_heading_after_rad(1);
  if (!moves && (observation.target_m - pose.position_m()).norm() > config_.heading_within_m)
    heading_rad.reset();
  const geometry::Vector2 resting_m = observer_.after(pose, observation.rest()).position_m();
  const bool there = (observation.target_after_m(1) - resting_m).norm() <= config_.boundary_m;
  const bool lies_well = !heading_rad || turn_between_rad(pose.heading_rad, *heading_rad) <=
                                             config_.heading_deg * geometry::kRadPerDeg;
  if (there && lies_well && !observation.awaited) return observation.rest();
  return inverse(aim(observation, heading_rad), pose);
}

ObserverController::Aim ObserverController::aim(const task::Observation& observation,
                                                std::optional<double> heading_rad) const {
  const geometry::Vector2 position_m = observation.pose.position_m();
  const geometry::Vector2 sliding_m = observation.target_m - position_m;
  const double distance_m = sliding_m.norm();
  const double left_m = std::max(0.0, (1.0 - config_.reaching_share) * distance_m - config_.switching_m);
  geometry::Vector2 way_m = observation.target_after_m(1) - position_m;
  if (distance_m > 0.0) way_m -= left_m / distance_m * sliding_m;
  const double length_m = way_m.norm();
  if (length_m > config_.longest_m) way_m *= config_.longest_m / length_m;
  geometry::Vector2 motion_m = way_m - observer_.disturbance_m();
  const double motion_length_m = motion_m.norm();
  if (motion_length_m == 0.0) {
    const double any_rad = heading_rad.value_or(observation.pose.heading_rad);
    motion_m = kShortestMotion_m * geometry::Vector2(std::cos(any_rad), std::sin(any_rad));
  } else if (motion_length_m < kShortestMotion_m) {
    motion_m *= kShortestMotion_m / motion_length_m;
  }
  return {position_m + way_m, motion_m, heading_rad};
}

/// The weakest pulse of a direction that moves the needle as far as it is to come, the full one where none
/// does; where a heading is wanted, or a part of it.
ObserverController::Candidate ObserverController::best_along(double direction_rad, const Aim& aim,
                                                             const geometry::Pose2& pose) const {
  const geometry::Drive full = model_->full_action(direction_rad, pose.position_m());
  Candidate best{geometry::Drive::Zero(full.size()), std::numeric_limits<double>::infinity()};
  if (full.isZero(0.0)) return best;
  double low = kWeakestPart;
  double high = 1.0;
  for (int i = 0; i < kPartHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    const geometry::Pose2 then = observer_.modelled(pose, scale_A_ * middle * full);
    const double moved_m = (then.position_m() - pose.position_m()).norm();
    (moved_m >= aim.motion_m.norm() ? high : low) = middle;
  }
  const auto consider = [&](double part) {
    const geometry::Pose2 then = observer_.after(pose, scale_A_ * part * full);
    double cost_mm = geometry::kMmPerM * (then.position_m() - aim.point_m).norm();
    if (aim.heading_rad)
      cost_mm += config_.heading_cost_mm * turn_between_rad(then.heading_rad, *aim.heading_rad);
    if (cost_mm < best.cost_mm) best = {part * full, cost_mm};
  };
  consider(high);
  if (aim.heading_rad)
    for (const double part : kTurningParts) consider(part * high);
  return best;
}

geometry::Drive ObserverController::inverse(const Aim& aim, const geometry::Pose2& pose) const {
  double centre_rad = std::atan2(aim.motion_m.y(), aim.motion_m.x());
  Candidate best = best_along(centre_rad, aim, pose);
  double best_rad = centre_rad;
  const auto look = [&](double direction_rad) {
    Candidate other = best_along(direction_rad, aim, pose);
    if (other.cost_mm >= best.cost_mm) return;
    best = other;
    best_rad = direction_rad;
  };
  const int steps = aim.heading_rad ? kFanAround : kFanSide;
  for (int step = 1; step <= steps; ++step)
    for (const double side : {1.0, -1.0}) look(centre_rad + side * step * kFanStep_rad);
  double step_rad = kFanStep_rad;
  for (int i = 0; i < kFanHalvings; ++i) {
    step_rad /= 2.0;
    centre_rad = best_rad;
    for (const double side : {1.0, -1.0}) look(centre_rad + side * step_rad);
  }
  return best.action;
}

}  // namespace lodestone::control
