#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/modelled_field.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {

/// The simulator of section IV-C, which the paper shows failing to transfer. The rig is that of the
/// description; friction is one number for the whole dish, moving or not: the mean of static and kinetic.
struct PlainSimulatorConfig {
  double step_s = 0.5e-3;  // D

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("step_s", step_s, "s", "integration step", {1e-6, 5e-3});
  }
};

/// Coils as ModelledField has them, of the paper's rig point dipoles, and a point-dipole needle (force =
/// grad(m.B), torque = m x B), Stokes drag of a slender rod in free fluid, uniform Coulomb friction, currents
/// without lag, and a wall that stops the needle's middle. A sphere has Stokes' drag of one, its moment
/// points along the field, and its heading stays as it is. Stateless.
class PlainSimulator {
 public:
  PlainSimulator(const RigDescription& rig, const PlainSimulatorConfig& config);

  /// Pose after a pulse (A) and a rest, from standstill.
  geometry::Pose2 step(const geometry::Pose2& pose, const PerCoil& current_A, double pulse_s,
                       double rest_s) const;

  /// Magnetic force (N) and torque (N m) on the needle.
  struct Load {
    geometry::Vector2 force_N;
    double torque_N_m;
  };
  Load load(const geometry::Pose2& pose, const PerCoil& current_A) const;

 private:
  geometry::Vector2 moment_A_m2(const geometry::Pose2& pose, const geometry::Vector2& field_T) const;

  NeedleConfig needle_;
  double dish_radius_m_;
  double friction_N_;
  double step_s_;
  ModelledField field_;
  double drag_N_s_m_;
  double spin_drag_N_m_s_;
};

}  // namespace lodestone::physics
