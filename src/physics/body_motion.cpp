#include "lodestone/physics/body_motion.h"

namespace lodestone::physics {

namespace {

std::variant<NeedleMotion, SphereMotion> motion_of(const RigDescription& rig) {
  if (rig.needle.is_sphere()) return SphereMotion(rig.needle, rig.fluid, rig.friction, rig.dish);
  return NeedleMotion(rig.needle, rig.fluid, rig.friction, rig.dish);
}

}  // namespace

BodyMotion::BodyMotion(const RigDescription& rig) : motion_(motion_of(rig)) {}

void BodyMotion::step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A,
                      const FrictionMap& map, double friction_scale, double step_s) const {
  std::visit([&](const auto& motion) { motion.step(state, coils, current_A, map, friction_scale, step_s); },
             motion_);
}

bool BodyMotion::fits(const geometry::Pose2& pose) const {
  return std::visit([&](const auto& motion) { return motion.fits(pose); }, motion_);
}

}  // namespace lodestone::physics
