#pragma once

#include <optional>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/flow.h"
#include "lodestone/physics/friction_map.h"
#include "lodestone/physics/needle.h"
#include "lodestone/physics/obstacles.h"

namespace lodestone::physics {

/// The dish.
struct DishConfig {
  double radius_m = 0.0425;          // Q: inner diameter 85 mm
  double wall_friction = 0.20;       // D: as the floor's kinetic coefficient
  double wall_height_m = 0.010;      // D: top of the wall above the floor
  double wall_thickness_m = 0.0015;  // D
  double holder_m = 0.05;            // D: where the paper's coils have their faces

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("radius_m", radius_m, "m", "inner radius of the dish", {5e-3, 0.5});
    v.field("wall_friction", wall_friction, "", "friction coefficient of needle ends on the wall",
            {0.0, 5.0});
    v.field("wall_height_m", wall_height_m, "m", "top of the dish wall above its floor, as a camera sees it",
            {0.0, 0.1});
    v.field("wall_thickness_m", wall_thickness_m, "m", "thickness of the dish wall", {1e-4, 0.05});
    v.field("holder_m", holder_m, "m",
            "of rigs that list their coils: half the width of the square holder that the dish stands in, its "
            "sides along x and y, by which the camera's axes are found; else the coils' faces are that",
            {5e-3, 0.5});
  }
};

/// Where the needle is and how it moves.
struct NeedleState {
  geometry::Pose2 pose;
  double velocity_x_m_s = 0.0;
  double velocity_y_m_s = 0.0;
  double spin_rad_s = 0.0;
  double roll_x_m_s = 0.0;  ///< of a sphere, and of its velocity: what it rolls by, and does not slide
  double roll_y_m_s = 0.0;
  bool stuck = true;  ///< held by static friction, velocities exactly zero
};

/// The needle's equations of motion (eqs. 8 and 9) with the real rig's friction.
///
/// Drag and friction are implicit and the magnetic load is taken at mid-step (a drift-kick-drift scheme), so
/// steps of 0.5 ms are stable and rest is exact. Floor friction acts on six equal cells along the rod, each
/// with its own place on the friction map and its own sliding direction: translation and rotation are
/// therefore coupled as for a real rod. A needle at rest stays until its load leaves the static limit surface
/// of the rod, |torque|^2 = (1 - f^2)(1 - f_across^2) in units of the greatest torque and force; this is
/// exact for a pure force, a pure torque and a torque with a force across, and within 3 % otherwise. What the
/// field lifts, the floor does not carry: friction is less by its share of the weight, and none where it is
/// all of it (a needle that leaves the floor is out of the model).
///
/// In fluid that moves, drag is that of the velocity relative to it, cell by cell with the coefficients of
/// the whole rod (resistive-force theory: Gray and Hancock, J. Exp. Biol. 32, 1955), so that the mean flow
/// along the rod carries it and what differs along the rod turns it; a needle at rest is held against that
/// drag, too. Wall and obstacles stop it alike: inelastically, with the friction of the wall.
class NeedleMotion {
 public:
  NeedleMotion(const NeedleConfig& needle, const FluidConfig& fluid, const FrictionConfig& friction,
               const DishConfig& dish, const Flow& flow = Flow(), const Obstacles& obstacles = Obstacles());

  /// Advances by `step_s` from `time_s` on under constant currents. `friction_scale` multiplies the map
  /// (scatter between pulses). A needle that was clear of the obstacles still is.
  void step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A, const FrictionMap& map,
            double friction_scale, double step_s, double time_s = 0.0) const;

  /// Whether the fluid can set a needle in motion that rests.
  bool fluid_moves() const { return !flow_.still(); }
  /// Whether both ends of the needle are inside the wall.
  bool fits(const geometry::Pose2& pose) const;
  /// Whether it fits, and no obstacle reaches into it.
  bool free_at(const geometry::Pose2& pose) const;
  /// The pose itself where the needle is free there, else the nearest place to within a millimetre where it
  /// is, with the same heading, or where there is none with one that is turned by as few steps of 30 degrees
  /// as possible. Nothing where the whole dish has no such place.
  std::optional<geometry::Pose2> free_near(const geometry::Pose2& pose) const;
  /// Whether static friction holds a resting needle against a load.
  bool holds(const geometry::Pose2& pose, const Wrench& load, const FrictionMap& map,
             double friction_scale) const;

 private:
  static constexpr int kCells = 6;
  struct BodyVelocity;
  struct Axes;
  struct Resistance;
  struct Stream;
  struct Contact;

  double carried_share(double lift_N) const;
  static Axes axes_of(const geometry::Pose2& pose);
  void cell_factors(const geometry::Pose2& pose, const Axes& axes, const FrictionMap& map, double scale,
                    double* factors) const;
  bool holds(const BodyVelocity& load, const double* factors) const;
  Stream stream_at(const geometry::Pose2& pose, const Axes& axes, double time_s) const;
  Resistance resistance(const BodyVelocity& velocity, const double* factors, const Stream& stream) const;
  BodyVelocity dragged(const BodyVelocity& load, const Resistance& resisting, const Stream& stream) const;
  bool kick(BodyVelocity& velocity, const BodyVelocity& load, const double* factors, const Stream& stream,
            bool held, double step_s) const;
  bool near_wall(const geometry::Pose2& pose) const;
  Capsule capsule_at(const geometry::Pose2& pose, const Axes& axes) const;
  void find_at_wall(const NeedleState& state, const Axes& axes, double step_s,
                    std::vector<Contact>& contacts) const;
  void find_at_obstacles(const NeedleState& state, const Axes& axes, double step_s,
                         std::vector<Contact>& contacts) const;
  void settle(Contact& contact, NeedleState& state, double& change) const;
  void contact_impulses(NeedleState& state, const Axes& axes, double step_s) const;
  void advance(NeedleState& state, double time_s) const;
  void keep_inside(geometry::Pose2& pose) const;
  bool keep_clear(geometry::Pose2& pose) const;

  NeedleConfig needle_;
  FluidConfig fluid_;
  FrictionConfig friction_;
  DishConfig dish_;
  Flow flow_;
  Obstacles obstacles_;
  RodDrag drag_;
  double cell_position_m_[kCells];
  double cell_load_N_;
};

}  // namespace lodestone::physics
