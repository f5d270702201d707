#include "lodestone/control/dipole_pull.h"

#include <algorithm>

#include "lodestone/geometry/saturation.h"

namespace lodestone::control {

DipolePull::DipolePull(const physics::RigDescription& rig)
    : moment_A_m2_(rig.needle.moment_A_m2), field_(rig) {}

geometry::Vector2 DipolePull::pull_N(const geometry::Drive& drive_A,
                                     const geometry::Vector2& position_m) const {
  const physics::FieldGradient at = field_.at(drive_A, position_m);
  const double magnitude_T = at.field_T.norm();
  if (magnitude_T == 0.0) return geometry::Vector2::Zero();
  return moment_A_m2_ * (at.gradient_T_per_m.transpose() * at.field_T) / magnitude_T;
}

geometry::Drive DipolePull::drive_A(const geometry::Vector2& force_N,
                                    const geometry::Vector2& position_m) const {
  const geometry::Vector2 nothing = geometry::Vector2::Zero();
  const double wanted_N = force_N.norm();
  if (wanted_N == 0.0) return field_.along(nothing, position_m);
  const geometry::Vector2 direction = force_N / wanted_N;
  const auto pull_of = [&](const geometry::Vector2& two_A) {
    return pull_N(field_.along(two_A, position_m), position_m);
  };
  const geometry::Vector2 unit = unit_drive_along(direction, pull_of);
  const double along_N = pull_of(unit).dot(direction);
  if (along_N <= 0.0) return field_.along(nothing, position_m);
  return field_.along(unit * (wanted_N / along_N), position_m);
}

void DipolePullController::observe(const task::Observation& observation) {
  if (observation.last_action.isZero(0.0)) return;
  // What was given, whatever came between: largest currents, decorators.
  const geometry::Vector2& moved_m = observation.last_displacement_m;
  const geometry::Vector2 given_N =
      pull_.pull_N(scale_A_ * observation.last_action, observation.pose.position_m() - moved_m);
  const double pull_N = given_N.norm();
  if (pull_N == 0.0) return;
  const double along_m = moved_m.dot(given_N) / pull_N;
  const double seen_N = pull_N - friction_N_ - along_m / config_.mobility_m_per_N;
  disturbance_N_ += config_.observer_share * (seen_N - disturbance_N_);
  disturbance_N_ = std::clamp(disturbance_N_, -friction_N_, config_.max_force_N);
}

geometry::Drive DipolePullController::act(const task::Observation& observation) {
  observe(observation);
  const geometry::Vector2 position_m = observation.pose.position_m();
  const geometry::Vector2 error_m = observation.target_after_m(1) - position_m;
  const double distance_m = error_m.norm();
  if (distance_m == 0.0 || distance_m < config_.rest_radius_m) return observation.rest();
  const double force_N =
      std::min(friction_N_ + disturbance_N_ + config_.gain_N_m * distance_m, config_.max_force_N);
  const geometry::Drive action = pull_.drive_A(error_m * (force_N / distance_m), position_m) / scale_A_;
  return geometry::saturated_in_direction(action);
}

}  // namespace lodestone::control
