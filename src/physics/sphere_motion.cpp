#include "lodestone/physics/sphere_motion.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::physics {

namespace {

using geometry::Vector2;

// A field steeper than this against the dish leaves the moment no axis in the plane to roll about.
constexpr double kUprightField = 0.1;

void drift_sphere(NeedleState& state, double time_s) {
  state.pose.x_m += state.velocity_x_m_s * time_s;
  state.pose.y_m += state.velocity_y_m_s * time_s;
}

}  // namespace

SphereDrag sphere_drag(const NeedleConfig& needle, const FluidConfig& fluid) {
  const double radius = 0.5 * needle.diameter_m;
  const double stokes = 6.0 * geometry::kPi * fluid.viscosity_Pa_s * radius;
  const double narrow = std::log(radius / fluid.wall_gap_m);
  // Of Stokes' force: against sliding and, at the same speed of the surface, against turning; and what
  // turning helps sliding. Rolling is both at once.
  const double sliding = 8.0 / 15.0 * narrow + 0.9588;
  const double turning = 4.0 / 3.0 * (2.0 / 5.0 * narrow + 0.3817);
  const double helping = 2.0 / 15.0 * narrow - 0.2526;
  return {stokes * std::max(1.0, sliding),
          stokes * std::max(1.0 + 4.0 / 3.0, sliding + turning - 2.0 * helping)};
}

FreeMomentPull free_moment_pull(const NeedleConfig& needle, const Vector2& middle_m, const CoilArray& coils,
                                const PerCoil& current_A) {
  FreeMomentPull pull;
  pull.field_T = coils.spatial_field_T(current_A, middle_m);
  const double strength_T = pull.field_T.norm();
  if (strength_T == 0.0) return pull;
  const double step_m = 0.25 * needle.diameter_m;
  const auto field_T = [&](double x_m, double y_m) -> Eigen::Vector3d {
    return coils.spatial_field_T(current_A, middle_m + Vector2(x_m, y_m));
  };
  const Eigen::Vector3d east_T = field_T(step_m, 0.0), west_T = field_T(-step_m, 0.0);
  const Eigen::Vector3d north_T = field_T(0.0, step_m), south_T = field_T(0.0, -step_m);
  pull.force_N = needle.moment_A_m2 / (2.0 * step_m) *
                 Vector2(east_T.norm() - west_T.norm(), north_T.norm() - south_T.norm());
  if (coils.planar()) return pull;
  // There is no current where the sphere is: the field has neither curl nor divergence.
  const Eigen::Vector3d by_x = (east_T - west_T) / (2.0 * step_m);
  const Eigen::Vector3d by_y = (north_T - south_T) / (2.0 * step_m);
  const Eigen::Vector3d by_z(by_x.z(), by_y.z(), -by_x.x() - by_y.y());
  pull.lift_N = needle.moment_A_m2 * pull.field_T.dot(by_z) / strength_T;
  return pull;
}

SphereMotion::SphereMotion(const NeedleConfig& needle, const FluidConfig& fluid,
                           const FrictionConfig& friction, const DishConfig& dish)
    : needle_(needle),
      fluid_(fluid),
      friction_(friction),
      dish_(dish),
      drag_(sphere_drag(needle, fluid)),
      radius_m_(0.5 * needle.diameter_m),
      reach_m_(dish.radius_m - radius_m_),
      rolling_mass_kg_(needle.inertia_kg_m2 / (radius_m_ * radius_m_)) {
  needle.validate();
  friction.validate();
}

double SphereMotion::sliding_coefficient(double speed_m_s) const {
  return friction_.kinetic_coefficient + (friction_.static_coefficient - friction_.kinetic_coefficient) *
                                             std::exp(-speed_m_s / friction_.stribeck_speed_m_s);
}

double SphereMotion::inertial_drag_N_s_m(double speed_m_s) const {
  constexpr double kShare = 0.15, kPower = 0.687;
  const double reynolds_Pa_s = fluid_.density_kg_m3 * speed_m_s * needle_.diameter_m;  // times viscosity
  return 6.0 * geometry::kPi * radius_m_ * fluid_.cross_flow_factor * kShare *
         std::pow(reynolds_Pa_s, kPower) * std::pow(fluid_.viscosity_Pa_s, 1.0 - kPower);
}

/// One implicit step of the velocity, along the field and across it. It comes to rest where neither is left.
void SphereMotion::kick(NeedleState& state, const FreeMomentPull& pull, double friction_scale,
                        double step_s) const {
  const Vector2 velocity_m_s(state.velocity_x_m_s, state.velocity_y_m_s);
  const Vector2 roll_m_s(state.roll_x_m_s, state.roll_y_m_s);
  const double carried_N = friction_scale * std::max(0.0, needle_.net_weight_N - pull.lift_N);
  const double sliding_N = carried_N * sliding_coefficient((velocity_m_s - roll_m_s).norm());
  const double rolling_N =
      carried_N * std::min(friction_.rolling_arm_m / radius_m_, friction_.kinetic_coefficient);
  const double inertial_N_s_m = inertial_drag_N_s_m(velocity_m_s.norm());
  const double strength_T = pull.field_T.norm();
  const Vector2 in_plane_T = pull.field_T.head<2>();
  const bool held = needle_.moment_A_m2 * strength_T >= carried_N * friction_.static_coefficient * radius_m_;
  const bool upright = in_plane_T.norm() <= kUprightField * strength_T;
  const Vector2 along = upright ? Vector2(1.0, 0.0) : Vector2(in_plane_T.normalized());
  const Vector2 across(-along.y(), along.x());
  Vector2 next_m_s = Vector2::Zero(), next_roll_m_s = Vector2::Zero();
  const auto move = [&](const Vector2& axis, bool rolls) {
    const double rolling_kg = rolls ? rolling_mass_kg_ : 0.0;
    const double push = needle_.mass_kg * axis.dot(velocity_m_s) + rolling_kg * axis.dot(roll_m_s) +
                        step_s * axis.dot(pull.force_N);
    const double left = std::max(0.0, std::abs(push) - step_s * (rolls ? rolling_N : sliding_N));
    const double drag_N_s_m = inertial_N_s_m + (rolls ? drag_.rolling_N_s_m : drag_.sliding_N_s_m);
    const double speed_m_s = std::copysign(left, push) / (needle_.mass_kg + rolling_kg + step_s * drag_N_s_m);
    next_m_s += speed_m_s * axis;
    if (rolls) next_roll_m_s += speed_m_s * axis;
  };
  move(along, !held);
  move(across, !held || !upright);
  state.stuck = next_m_s.isZero(0.0);
  state.velocity_x_m_s = next_m_s.x();
  state.velocity_y_m_s = next_m_s.y();
  state.roll_x_m_s = next_roll_m_s.x();
  state.roll_y_m_s = next_roll_m_s.y();
}

void SphereMotion::step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A,
                        const FrictionMap& map, double friction_scale, double step_s) const {
  if (!state.stuck) {
    drift_sphere(state, step_s / 2.0);
    keep_inside(state.pose);
  }
  const FreeMomentPull pull = free_moment_pull(needle_, state.pose.position_m(), coils, current_A);
  kick(state, pull, friction_scale * map.factor(state.pose.x_m, state.pose.y_m), step_s);
  if (state.stuck) return;
  meet_wall(state, step_s);
  drift_sphere(state, step_s / 2.0);
  keep_inside(state.pose);
}

bool SphereMotion::fits(const geometry::Pose2& pose) const {
  return pose.position_m().norm() <= reach_m_;  // NaN does not fit either
}

/// Takes away what would pass the wall within the step, and of what is left along it as much as the wall's
/// friction does. What rolls against the wall stops rolling.
void SphereMotion::meet_wall(NeedleState& state, double step_s) const {
  const Vector2 middle_m = state.pose.position_m();
  const double distance_m = middle_m.norm();
  if (distance_m == 0.0) return;
  const Vector2 normal = middle_m / distance_m;
  const Vector2 tangent(-normal.y(), normal.x());
  Vector2 velocity_m_s(state.velocity_x_m_s, state.velocity_y_m_s);
  const double allowed_m_s = std::max(0.0, reach_m_ - distance_m) / step_s;
  const double lost_m_s = normal.dot(velocity_m_s) - allowed_m_s;
  if (lost_m_s <= 0.0) return;
  const double beside_m_s = tangent.dot(velocity_m_s);
  const double rubbed_m_s = std::min(std::abs(beside_m_s), dish_.wall_friction * lost_m_s);
  velocity_m_s -= lost_m_s * normal + std::copysign(rubbed_m_s, beside_m_s) * tangent;
  Vector2 roll_m_s(state.roll_x_m_s, state.roll_y_m_s);
  roll_m_s -= std::max(0.0, normal.dot(roll_m_s)) * normal;
  state.velocity_x_m_s = velocity_m_s.x();
  state.velocity_y_m_s = velocity_m_s.y();
  state.roll_x_m_s = roll_m_s.x();
  state.roll_y_m_s = roll_m_s.y();
}

/// Takes back the little that the wall's curvature lets it through in one step.
void SphereMotion::keep_inside(geometry::Pose2& pose) const {
  const double distance_m = pose.position_m().norm();
  if (distance_m <= reach_m_) return;
  const double back = reach_m_ * (1.0 - 1e-12) / distance_m;
  pose.x_m *= back;
  pose.y_m *= back;
}

}  // namespace lodestone::physics
