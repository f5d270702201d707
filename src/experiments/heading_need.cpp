#include "lodestone/experiments/heading_need.h"

#include "lodestone/common/error.h"

namespace lodestone::experiments {

void refuse_heading(const physics::RigDescription& rig, const inference::Policy& policy,
                    const std::string& what) {
  const bool needed = policy.encoder.heading != task::HeadingEncoding::kNone || policy.encoder.target_heading;
  if (rig.needle.is_sphere() && needed)
    throw common::ConfigError(what +
                              ": the policy goes by a heading, and this rig's sphere (rig.needle.shape) has "
                              "none; train one on a simulator of spheres");
}

void refuse_heading(const physics::RigDescription& rig, const inference::DynamicsModel& model,
                    const std::string& what) {
  if (rig.needle.is_sphere() && model.info.layout != data::StateLayout::kPosition)
    throw common::ConfigError(what +
                              ": the simulator's states have a heading, and this rig's sphere "
                              "(rig.needle.shape) has none; learn one from a recording of a sphere");
}

void refuse_heading(const physics::RigDescription& rig, const std::string& task) {
  if (rig.needle.is_sphere() && (task == "pose" || task == "suture"))
    throw common::ConfigError("task = \"" + task +
                              "\": a sphere (rig.needle.shape) has no heading to be turned to; use " +
                              (task == "pose" ? "point" : "a path"));
}

}  // namespace lodestone::experiments
