#pragma once

#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"

namespace lodestone::physics {

/// kNeedle: a rod or a capsule with a heading, that of its magnets. kSphere: its moment is free to turn, and
/// nobody sees where it points: it has no heading, and where a pose holds one, that is 0.
enum class NeedleShape { kNeedle, kSphere };
inline std::vector<std::string> names_of(NeedleShape) { return {"needle", "sphere"}; }

/// A suture needle (steel tube) with a chain of magnets inside; or a capsule, down to one as long as thick;
/// or a sphere.
struct NeedleConfig {
  NeedleShape shape = NeedleShape::kNeedle;
  double length_m = 23.5e-3;       // Q
  double diameter_m = 0.7176e-3;   // Q: 22 gauge
  double chain_m = 21e-3;          // D: 42 magnets (Q) of 0.3 x 0.5 mm (D)
  double moment_A_m2 = 1.69e-3;    // I: Br 1.43 T; range 1.6e-3 to 3.0e-3
  double mass_kg = 63.5e-6;        // I
  double net_weight_N = 0.526e-3;  // I: weight less buoyancy
  double inertia_kg_m2 = 2.9e-9;   // I
  double tape_length_m = 3e-3;     // D: bright tape at the head

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("shape", shape, "",
            "needle: a rod or a capsule, with a heading; sphere: without one, as long as thick, and without "
            "tape");
    v.field("length_m", length_m, "m", "length of the needle", {1e-3, 0.08});
    v.field("diameter_m", diameter_m, "m", "outer diameter", {1e-5, 0.01});
    v.field("chain_m", chain_m, "m", "length of the magnet chain (distance of its poles)", {1e-4, 0.08});
    v.field("moment_A_m2", moment_A_m2, "A m^2", "magnetic moment of the chain", {0.0, 1.0});
    v.field("mass_kg", mass_kg, "kg", "mass", {1e-7, 1.0});
    v.field("net_weight_N", net_weight_N, "N", "weight less buoyancy: what presses on the dish", {0.0, 1.0});
    v.field("inertia_kg_m2", inertia_kg_m2, "kg m^2",
            "moment of inertia about the vertical through the middle", {1e-14, 1.0});
    v.field("tape_length_m", tape_length_m, "m", "length of the bright tape on its head", {1e-4, 0.1});
  }
  /// Throws ConfigError when the chain is longer than the needle, or that thicker than long, or a sphere not
  /// as long as thick.
  void validate() const;

  bool is_sphere() const { return shape == NeedleShape::kSphere; }
};

/// What the needle lies in.
struct FluidConfig {
  double viscosity_Pa_s = 1.66e-3;  // I: 25 ml water + 5 ml glycerol at 22 C, Cheng 2008
  double density_kg_m3 = 1046.0;    // I
  double wall_gap_m = 10e-6;        // D: fluid film under the needle
  double cross_flow_factor = 1.0;   // D: scales White's cylinder drag; 0 leaves viscous drag alone
  double depth_m = 0.0;             // D: 25 + 5 ml in the dish would be 5.3 mm deep
  double refractive_index = 1.36;   // I: 20 % of glycerol by mass

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("viscosity_Pa_s", viscosity_Pa_s, "Pa s", "dynamic viscosity", {0.0, 100.0});
    v.field("density_kg_m3", density_kg_m3, "kg/m^3", "density", {1.0, 2e4});
    v.field("wall_gap_m", wall_gap_m, "m", "fluid film between needle and dish", {1e-8, 0.1});
    v.field("cross_flow_factor", cross_flow_factor, "", "scale of the cross-flow drag", {0.0, 10.0});
    v.field("depth_m", depth_m, "m",
            "depth that a camera sees the floor through; 0: it is calibrated as if there were no fluid",
            {0.0, 0.1});
    v.field("refractive_index", refractive_index, "", "of the fluid, where its depth is given", {1.0, 3.0});
  }
};

/// Force (N, dish frame) and torque about the needle's middle (N m, counter-clockwise, seen from above).
struct Wrench {
  double force_x_N = 0.0;
  double force_y_N = 0.0;
  double torque_N_m = 0.0;
  double lift_N = 0.0;  ///< upwards; 0 where coils and needle lie in one plane
};

/// Uniformly magnetised rod: a pole +moment/chain at the head end of the chain and its opposite at the tail
/// end.
Wrench magnetic_wrench(const NeedleConfig& needle, const geometry::Pose2& pose, const CoilArray& coils,
                       const PerCoil& current_A);
/// The same for a middle and a unit vector along the heading.
Wrench magnetic_wrench(const NeedleConfig& needle, const geometry::Vector2& middle_m,
                       const geometry::Vector2& axis, const CoilArray& coils, const PerCoil& current_A);

/// Viscous coefficients of the rod, linear in speed.
struct RodDrag {
  double along_N_s_m = 0.0;
  double across_N_s_m = 0.0;
  double rotation_N_m_s = 0.0;
};

/// Slender rod beside a wall: 2 pi mu / acosh(h / r) per length along the axis, double across (Jeffrey and
/// Onishi 1981 for a cylinder beside a plane), never below the rod in free fluid (Tirado and Garcia de la
/// Torre 1979-80).
RodDrag rod_drag(const NeedleConfig& needle, const FluidConfig& fluid);

/// Drag (N) on a needle at rest of fluid that flows past it at right angles, the most that fluid of a speed
/// does to it: rod_drag() and the cross-flow drag of a cylinder (White, Viscous Fluid Flow), as NeedleMotion
/// has it.
double broadside_drag_N(const NeedleConfig& needle, const FluidConfig& fluid, double speed_m_s);
/// The speed (m/s) at which that is `drag_N`. Throws LogicFault unless fluid has any drag and `drag_N` is
/// above 0.
double broadside_speed_m_s(const NeedleConfig& needle, const FluidConfig& fluid, double drag_N);

}  // namespace lodestone::physics
