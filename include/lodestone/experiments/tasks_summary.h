#pragma once

#include <vector>

#include "lodestone/physics/rig_description.h"
#include "lodestone/runs/plan.h"
#include "lodestone/runs/tasks_result.h"

namespace lodestone::experiments {

/// One task by one controller, of at least one trial; without what it is compared with.
runs::TaskFigures task_figures(const std::vector<runs::TrialRecord>& trials);

/// What the finished cells of tasks_plan() measured on `rig`. Throws DataError where one is damaged.
runs::TasksSummary summarise_tasks(const runs::Plan& plan, const runs::PlanPlace& place,
                                   const physics::RigDescription& rig);

}  // namespace lodestone::experiments
