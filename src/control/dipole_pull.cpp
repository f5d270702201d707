#include "lodestone/control/dipole_pull.h"

#include <algorithm>
#include <cmath>

#include "lodestone/task/action.h"

namespace lodestone::control {

namespace {
constexpr double kPi = 3.14159265358979323846;
}

DipolePull::DipolePull(const DipolePullConfig& config) : moment_A_m2_(config.needle_moment_A_m2) {
  for (int coil = 0; coil < 4; ++coil) coils_.emplace_back(config.coil, coil);
}

geometry::Vector2 DipolePull::pull_N(const geometry::Vector2& axis_drive_A,
                                     const geometry::Vector2& position_m) const {
  const auto current_A = task::coil_currents(axis_drive_A);
  physics::FieldGradient at;
  for (std::size_t coil = 0; coil < coils_.size(); ++coil)
    if (current_A[coil] != 0.0) coils_[coil].add(current_A[coil], position_m, at);
  const double magnitude_T = at.field_T.norm();
  if (magnitude_T == 0.0) return geometry::Vector2::Zero();
  return moment_A_m2_ * (at.gradient_T_per_m.transpose() * at.field_T) / magnitude_T;
}

geometry::Vector2 DipolePull::drive_A(const geometry::Vector2& force_N,
                                      const geometry::Vector2& position_m) const {
  const double wanted_N = force_N.norm();
  if (wanted_N == 0.0) return geometry::Vector2::Zero();
  const geometry::Vector2 direction = force_N / wanted_N;
  double best_angle = 0.0;
  double best_cosine = -2.0;
  const auto try_angle = [&](double angle) {
    const geometry::Vector2 pull = pull_N({std::cos(angle), std::sin(angle)}, position_m);
    const double size = pull.norm();
    const double cosine = size > 0.0 ? pull.dot(direction) / size : -1.0;
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best_angle = angle;
    }
  };
  constexpr int kCoarse = 72;
  for (int i = 0; i < kCoarse; ++i) try_angle(2.0 * kPi * i / kCoarse);
  for (double step = 2.0 * kPi / kCoarse / 2.0; step > 1e-4; step /= 2.0) {
    const double centre = best_angle;
    try_angle(centre - step);
    try_angle(centre + step);
  }
  const geometry::Vector2 unit(std::cos(best_angle), std::sin(best_angle));
  const double along_N = pull_N(unit, position_m).dot(direction);
  if (along_N <= 0.0) return geometry::Vector2::Zero();
  return unit * (wanted_N / along_N);
}

geometry::Vector2 DipolePullController::act(const task::Observation& observation) {
  const geometry::Vector2 error_m = observation.target_m - observation.pose.position_m();
  const double distance_m = error_m.norm();
  if (distance_m == 0.0) return geometry::Vector2::Zero();
  const double force_N = std::min(config_.friction_N + config_.gain_N_m * distance_m, config_.max_force_N);
  const geometry::Vector2 action =
      pull_.drive_A(error_m * (force_N / distance_m), observation.pose.position_m()) / scale_A_;
  return action / std::max(1.0, action.cwiseAbs().maxCoeff());
}

}  // namespace lodestone::control
