#pragma once

#include <string>

#include "lodestone/common/config.h"
#include "lodestone/runs/plan.h"

namespace lodestone::runs {

/// The build.ninja of a plan. Its only outputs are stamps: ninja may delete the outputs of what it
/// interrupts.
std::string ninja_text(const Plan& plan, const PlanPlace& place);

/// Runs the cells that are not finished, as many at a time as there are threads, by ninja; with `only`, that
/// cell and what it needs. What each says goes into FOLDER/ID.log. Throws Interrupted once all have stopped,
/// Error naming the cells that failed after the others have ended, and ConfigError where ninja is not
/// installed or there is no such cell.
void run_plan(const Plan& plan, const PlanPlace& place, const std::string& label,
              const std::string& only = "");

/// The same as a run of `verb` in the plan's folder, which holds one plan with the same `settings` and
/// rig: the same call goes on where it was. It is finished once all cells are. Throws ConfigError, too, where
/// the folder holds something else.
void run_plan_in_folder(const Plan& plan, const PlanPlace& place, const std::string& verb,
                        common::Json settings, const std::string& only);

}  // namespace lodestone::runs
