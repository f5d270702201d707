#pragma once

#include <string>
#include <vector>

#include "lodestone/physics/flow.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::experiments {

/// A flow that trials on a virtual rig are asked for by what it does to a needle, not by its speed.
enum class TrialFlow { kAsRig, kSteady, kPulsing };
inline std::vector<std::string> names_of(TrialFlow) { return {"as_rig", "steady", "pulsing"}; }

/// A flow over the whole dish, towards +x: steady, or rising and falling as a sine, once a second, to rest
/// and back. At its fastest its drag on a needle that lies across it is half of what friction holds. Throws
/// ConfigError where there is no such speed, and LogicFault for kAsRig.
physics::FlowConfig flow_by_drag(TrialFlow kind, const physics::RigDescription& rig);

}  // namespace lodestone::experiments
