#pragma once

#include <array>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_geometry.h"
#include "lodestone/physics/dipole_coil.h"

namespace lodestone::physics {

/// The simulator of section IV-C, which the paper shows failing to transfer.
struct PlainSimulatorConfig {
  CoilGeometry coil;
  double moment_A_m2 = 1.69e-3;        // I
  double mass_kg = 63.5e-6;            // I
  double inertia_kg_m2 = 2.9e-9;       // I
  double length_m = 23.5e-3;           // Q
  double diameter_m = 0.7176e-3;       // Q
  double net_weight_N = 0.526e-3;      // I
  double viscosity_Pa_s = 1.66e-3;     // I: at 22 C
  double friction_coefficient = 0.25;  // D: one number for the whole dish, moving or not
  double dish_radius_m = 0.0425;       // Q
  double step_s = 0.5e-3;              // D

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("coil", coil, "coils, used as point dipoles");
    v.field("moment_A_m2", moment_A_m2, "A m^2", "magnetic moment of the needle", {0.0, 1.0});
    v.field("mass_kg", mass_kg, "kg", "mass of the needle", {1e-7, 1.0});
    v.field("inertia_kg_m2", inertia_kg_m2, "kg m^2", "moment of inertia of the needle", {1e-14, 1.0});
    v.field("length_m", length_m, "m", "length of the needle", {1e-3, 0.08});
    v.field("diameter_m", diameter_m, "m", "diameter of the needle", {1e-5, 0.01});
    v.field("net_weight_N", net_weight_N, "N", "weight less buoyancy", {0.0, 1.0});
    v.field("viscosity_Pa_s", viscosity_Pa_s, "Pa s", "dynamic viscosity of the fluid", {0.0, 100.0});
    v.field("friction_coefficient", friction_coefficient, "", "Coulomb friction everywhere", {0.0, 5.0});
    v.field("dish_radius_m", dish_radius_m, "m", "inner radius of the dish", {5e-3, 0.5});
    v.field("step_s", step_s, "s", "integration step", {1e-6, 5e-3});
  }
};

/// Point-dipole coils and needle (force = grad(m.B), torque = m x B), Stokes drag of a slender rod in free
/// fluid, uniform Coulomb friction, currents without lag, and a wall that stops the needle's middle.
/// Stateless.
class PlainSimulator {
 public:
  explicit PlainSimulator(const PlainSimulatorConfig& config);

  /// Pose after a pulse of four currents (A) and a rest, from standstill.
  geometry::Pose2 step(const geometry::Pose2& pose, const std::array<double, 4>& current_A, double pulse_s,
                       double rest_s) const;

  /// Magnetic force (N) and torque (N m) on the needle.
  struct Load {
    geometry::Vector2 force_N;
    double torque_N_m;
  };
  Load load(const geometry::Pose2& pose, const std::array<double, 4>& current_A) const;

 private:
  PlainSimulatorConfig config_;
  std::vector<DipoleCoil> coils_;
  double drag_N_s_m_;
  double spin_drag_N_m_s_;
};

}  // namespace lodestone::physics
