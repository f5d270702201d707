#pragma once

#include <string>

#include "lodestone/inference/dynamics.h"
#include "lodestone/inference/policy.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::experiments {

/// What goes by a needle's heading, on a rig of a sphere, which has none: throws ConfigError.
void refuse_heading(const physics::RigDescription& rig, const inference::Policy& policy,
                    const std::string& what);
void refuse_heading(const physics::RigDescription& rig, const inference::DynamicsModel& model,
                    const std::string& what);
void refuse_heading(const physics::RigDescription& rig, const std::string& task);

}  // namespace lodestone::experiments
