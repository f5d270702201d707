#pragma once

#include <cstdint>
#include <memory>

#include "lodestone/control/goal_seeker.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/experiments/deployment.h"

namespace lodestone::experiments {

/// A controller that goes from target to target, which are drawn from `config.seed` and the session: what
/// collects while it drives usefully.
Teleoperator goal_seeking(const CollectionConfig& config, std::unique_ptr<control::Controller> controller,
                          const control::GoalSeekerConfig& seek, std::int64_t session = 0);

/// The same with a planner, on a rig that it comes to know meanwhile.
Teleoperator goal_seeking(const CollectionConfig& config, const SimulatorSource& simulator,
                          const control::PlannerConfig& planner,
                          const control::IdentificationConfig& identification,
                          const control::GoalSeekerConfig& seek, std::int64_t session = 0);

}  // namespace lodestone::experiments
