#include "lodestone/physics/needle.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::physics {

void NeedleConfig::validate() const {
  if (chain_m > length_m)
    throw common::InvalidConfig(
        "chain_m", chain_m,
        fmt::format("not exceed length_m = {}, for the magnets lie inside the needle", length_m));
  if (is_sphere() && length_m != diameter_m)
    throw common::InvalidConfig("length_m", length_m,
                                fmt::format("be diameter_m = {}, for shape is sphere", diameter_m));
  if (diameter_m > length_m)
    throw common::InvalidConfig("diameter_m", diameter_m,
                                fmt::format("not exceed length_m = {}: what lies in the dish is a rod, or a "
                                            "capsule, with a heading along its length",
                                            length_m));
}

Wrench magnetic_wrench(const NeedleConfig& needle, const geometry::Pose2& pose, const CoilArray& coils,
                       const PerCoil& current_A) {
  return magnetic_wrench(needle, pose.position_m(), {std::cos(pose.heading_rad), std::sin(pose.heading_rad)},
                         coils, current_A);
}

Wrench magnetic_wrench(const NeedleConfig& needle, const geometry::Vector2& middle_m,
                       const geometry::Vector2& axis, const CoilArray& coils, const PerCoil& current_A) {
  const double half = needle.chain_m / 2.0;
  const double pole_A_m = needle.moment_A_m2 / needle.chain_m;
  if (!coils.planar()) {
    const Eigen::Vector3d head = coils.spatial_field_T(current_A, middle_m + half * axis);
    const Eigen::Vector3d tail = coils.spatial_field_T(current_A, middle_m - half * axis);
    const Eigen::Vector3d force = pole_A_m * (head - tail);
    const Eigen::Vector3d sum = head + tail;
    return {force.x(), force.y(), pole_A_m * half * (axis.x() * sum.y() - axis.y() * sum.x()), force.z()};
  }
  const geometry::Vector2 head = coils.field_T(current_A, middle_m + half * axis);
  const geometry::Vector2 tail = coils.field_T(current_A, middle_m - half * axis);
  const geometry::Vector2 force = pole_A_m * (head - tail);
  const geometry::Vector2 sum = head + tail;
  return {force.x(), force.y(), pole_A_m * half * (axis.x() * sum.y() - axis.y() * sum.x())};
}

RodDrag rod_drag(const NeedleConfig& needle, const FluidConfig& fluid) {
  const double length = needle.length_m;
  const double radius = needle.diameter_m / 2.0;
  const double mu = fluid.viscosity_Pa_s;
  const double wall_per_m = 2.0 * geometry::kPi * mu / std::acosh(1.0 + fluid.wall_gap_m / radius);
  const double p = length / needle.diameter_m;
  const double log_p = std::log(p);
  const double free_along = 2.0 * geometry::kPi * mu * length / (log_p - 0.207 + 0.980 / p - 0.133 / (p * p));
  const double free_across =
      4.0 * geometry::kPi * mu * length / (log_p + 0.839 + 0.185 / p + 0.233 / (p * p));
  const double free_rotation =
      geometry::kPi * mu * length * length * length / 3.0 / (log_p - 0.662 + 0.917 / p - 0.050 / (p * p));
  RodDrag drag;
  drag.along_N_s_m = std::max(wall_per_m * length, free_along);
  drag.across_N_s_m = std::max(2.0 * wall_per_m * length, free_across);
  drag.rotation_N_m_s = std::max(2.0 * wall_per_m * length * length * length / 12.0, free_rotation);
  return drag;
}

double broadside_drag_N(const NeedleConfig& needle, const FluidConfig& fluid, double speed_m_s) {
  const double kinematic = fluid.viscosity_Pa_s / (fluid.density_kg_m3 * needle.diameter_m);
  const double inertial =
      0.5 * fluid.density_kg_m3 * needle.diameter_m * needle.length_m * fluid.cross_flow_factor;
  const double cross_flow_N =
      inertial * (speed_m_s + 10.0 * std::cbrt(kinematic * kinematic * speed_m_s)) * speed_m_s;
  return rod_drag(needle, fluid).across_N_s_m * speed_m_s + cross_flow_N;
}

double broadside_speed_m_s(const NeedleConfig& needle, const FluidConfig& fluid, double drag_N) {
  constexpr double kFastest_m_s = 1e6;
  LODESTONE_CHECK(drag_N > 0.0 && broadside_drag_N(needle, fluid, kFastest_m_s) > drag_N,
                  "fluid that has such a drag");
  double slow_m_s = 0.0, fast_m_s = kFastest_m_s;
  for (int halving = 0; halving < 200; ++halving) {
    const double middle_m_s = 0.5 * (slow_m_s + fast_m_s);
    (broadside_drag_N(needle, fluid, middle_m_s) < drag_N ? slow_m_s : fast_m_s) = middle_m_s;
  }
  return fast_m_s;
}

}  // namespace lodestone::physics
