#pragma once

#include <variant>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/friction_map.h"
#include "lodestone/physics/needle_motion.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/physics/sphere_motion.h"

namespace lodestone::physics {

/// The equations of motion of what lies in the dish, by its shape.
class BodyMotion {
 public:
  explicit BodyMotion(const RigDescription& rig);

  /// As NeedleMotion::step() or SphereMotion::step().
  void step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A, const FrictionMap& map,
            double friction_scale, double step_s) const;
  /// Whether it lies wholly inside the wall.
  bool fits(const geometry::Pose2& pose) const;

 private:
  std::variant<NeedleMotion, SphereMotion> motion_;
};

}  // namespace lodestone::physics
