#include "lodestone/physics/body_motion.h"

#include "lodestone/common/error.h"

namespace lodestone::physics {

namespace {

std::variant<NeedleMotion, SphereMotion> motion_of(const RigDescription& rig, const Flow& flow,
                                                   const Obstacles& obstacles) {
  if (!rig.needle.is_sphere())
    return NeedleMotion(rig.needle, rig.fluid, rig.friction, rig.dish, flow, obstacles);
  LODESTONE_CHECK(flow.still() && obstacles.empty(), "a sphere in fluid at rest, without obstacles");
  return SphereMotion(rig.needle, rig.fluid, rig.friction, rig.dish);
}

}  // namespace

BodyMotion::BodyMotion(const RigDescription& rig, const Flow& flow, const Obstacles& obstacles)
    : motion_(motion_of(rig, flow, obstacles)) {}

void BodyMotion::step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A,
                      const FrictionMap& map, double friction_scale, double step_s, double time_s) const {
  if (const auto* needle = std::get_if<NeedleMotion>(&motion_))
    needle->step(state, coils, current_A, map, friction_scale, step_s, time_s);
  else
    std::get<SphereMotion>(motion_).step(state, coils, current_A, map, friction_scale, step_s);
}

bool BodyMotion::fits(const geometry::Pose2& pose) const {
  return std::visit([&](const auto& motion) { return motion.fits(pose); }, motion_);
}

bool BodyMotion::free_at(const geometry::Pose2& pose) const {
  const auto* needle = std::get_if<NeedleMotion>(&motion_);
  return needle != nullptr ? needle->free_at(pose) : fits(pose);
}

std::optional<geometry::Pose2> BodyMotion::free_near(const geometry::Pose2& pose) const {
  if (const auto* needle = std::get_if<NeedleMotion>(&motion_)) return needle->free_near(pose);
  return fits(pose) ? std::optional(pose) : std::nullopt;
}

bool BodyMotion::fluid_moves() const {
  const auto* needle = std::get_if<NeedleMotion>(&motion_);
  return needle != nullptr && needle->fluid_moves();
}

}  // namespace lodestone::physics
