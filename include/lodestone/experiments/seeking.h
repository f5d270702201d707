#pragma once

#include <cstdint>

#include "lodestone/control/goal_seeker.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/experiments/deployment.h"

namespace lodestone::experiments {

/// A planner that goes from target to target on a rig that it comes to know meanwhile: what collects while it
/// drives usefully. Its random streams belong to `config.seed` and the session.
Teleoperator seeking_planner(const CollectionConfig& config, const SimulatorSource& simulator,
                             const control::PlannerConfig& planner,
                             const control::IdentificationConfig& identification,
                             const control::GoalSeekerConfig& seek, std::int64_t session = 0);

}  // namespace lodestone::experiments
