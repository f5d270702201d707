#pragma once

#include <Eigen/Core>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/friction_map.h"
#include "lodestone/physics/needle.h"
#include "lodestone/physics/needle_motion.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::physics {

/// Viscous coefficients of a sphere on the floor, linear in speed.
struct SphereDrag {
  double sliding_N_s_m = 0.0;  ///< without turning
  double rolling_N_s_m = 0.0;  ///< of its speed, turning so that it does not slide
};

/// Stokes' 6 pi mu r and 8 pi mu r^3, times what a wall at a small distance makes of them (Goldman, Cox and
/// Brenner, Chem. Eng. Sci. 22, 1967, for a narrow gap), never below the sphere in free fluid.
SphereDrag sphere_drag(const NeedleConfig& needle, const FluidConfig& fluid);

/// What coils do to a moment that is free to turn.
struct FreeMomentPull {
  Eigen::Vector3d field_T = Eigen::Vector3d::Zero();
  geometry::Vector2 force_N = geometry::Vector2::Zero();
  double lift_N = 0.0;  ///< upwards
};

/// Pull on a moment that points along the field, where it is: its size times the gradient of the field's
/// magnitude. Of a uniformly magnetised sphere that is exact, whatever its size. Differences are taken over
/// half its diameter; no point further than a quarter of it from the middle is asked for.
FreeMomentPull free_moment_pull(const NeedleConfig& needle, const geometry::Vector2& middle_m,
                                const CoilArray& coils, const PerCoil& current_A);

/// A magnetised sphere on the floor of a dish. Its place is all its state at rest.
///
/// The moment lies along the field at every time: what turns it there, moment times field, is many times what
/// friction and fluid could hold against it wherever coils can move the sphere, and takes milliseconds. That
/// torque also keeps it from rolling along the field, as rolling would turn the moment out of it: along the
/// field the sphere slides, with Coulomb friction as a needle has it. Turning about its moment costs nothing:
/// across the field it rolls, without slipping. Where moment times field is less than the torque of friction,
/// as after a pulse, nothing holds the moment, and it rolls in every direction. What resists rolling is the
/// torque `rolling_arm_m` times what the floor carries. The inertia of rolling, and what sliding gives up to
/// it, are in. To Stokes' drag beside the floor comes that of inertia, 0.15 Re^0.687 of it in free fluid
/// (Schiller and Naumann, 1933). The wall stops the sphere a radius before it, inelastically, with friction.
/// The same scheme as NeedleMotion: drift, kick, drift, with resistance implicit, so that rest is exact. What
/// the field lifts, the floor does not carry, as there.
class SphereMotion {
 public:
  SphereMotion(const NeedleConfig& needle, const FluidConfig& fluid, const FrictionConfig& friction,
               const DishConfig& dish);

  /// Advances by `step_s` under constant currents; the heading and the spin stay as they are.
  /// `friction_scale` multiplies the map (scatter between pulses).
  void step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A, const FrictionMap& map,
            double friction_scale, double step_s) const;

  /// Whether the sphere is inside the wall.
  bool fits(const geometry::Pose2& pose) const;

 private:
  void kick(NeedleState& state, const FreeMomentPull& pull, double friction_scale, double step_s) const;
  double sliding_coefficient(double speed_m_s) const;
  double inertial_drag_N_s_m(double speed_m_s) const;
  void meet_wall(NeedleState& state, double step_s) const;
  void keep_inside(geometry::Pose2& pose) const;

  NeedleConfig needle_;
  FluidConfig fluid_;
  FrictionConfig friction_;
  DishConfig dish_;
  SphereDrag drag_;
  double radius_m_;
  double reach_m_;          // of its middle
  double rolling_mass_kg_;  // inertia as a mass at the surface
};

}  // namespace lodestone::physics
