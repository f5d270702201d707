#pragma once

#include <optional>
#include <variant>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/flow.h"
#include "lodestone/physics/friction_map.h"
#include "lodestone/physics/needle_motion.h"
#include "lodestone/physics/obstacles.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/physics/sphere_motion.h"

namespace lodestone::physics {

/// The equations of motion of what lies in the dish, by its shape.
class BodyMotion {
 public:
  /// A sphere's fluid is at rest, and its dish empty: throws LogicFault where `flow` and `obstacles` say
  /// otherwise.
  explicit BodyMotion(const RigDescription& rig, const Flow& flow = {}, const Obstacles& obstacles = {});

  /// As NeedleMotion::step() or SphereMotion::step().
  void step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A, const FrictionMap& map,
            double friction_scale, double step_s, double time_s = 0.0) const;
  /// Whether it lies wholly inside the wall,
  bool fits(const geometry::Pose2& pose) const;
  /// and clear of obstacles, too.
  bool free_at(const geometry::Pose2& pose) const;
  /// As NeedleMotion::free_near().
  std::optional<geometry::Pose2> free_near(const geometry::Pose2& pose) const;
  /// Whether fluid that moves may move it.
  bool fluid_moves() const;

 private:
  std::variant<NeedleMotion, SphereMotion> motion_;
};

}  // namespace lodestone::physics
