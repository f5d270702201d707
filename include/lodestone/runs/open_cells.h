#pragma once

#include <string>
#include <vector>

#include "lodestone/runs/plan.h"

namespace lodestone::runs {

/// Cells that `name` names, in which * stands for any text, ? for any letter and [12] for one of these, as
/// for files in a shell but across slashes. In the plan's order.
std::vector<const Cell*> cells_named(const Plan& plan, const std::string& name);

/// Cells that are wanted: all, or those that `only` names with all they need. In the plan's order. Throws
/// ConfigError where there is no such cell.
std::vector<const Cell*> wanted_cells(const Plan& plan, const std::string& only = "");

/// Those that are not finished, neither in their own folders nor by kept records. In the plan's order.
std::vector<const Cell*> unfinished_cells(const Plan& plan, const PlanPlace& place,
                                          const std::vector<const Cell*>& cells);

/// What has to be run to finish these cells: the unfinished ones, and finished ones whose recordings or
/// weights are needed and not there. In the plan's order.
std::vector<const Cell*> cells_to_run(const Plan& plan, const PlanPlace& place,
                                      const std::vector<const Cell*>& cells);

}  // namespace lodestone::runs
