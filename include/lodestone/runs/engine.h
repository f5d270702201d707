#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/runs/plan.h"

namespace lodestone::runs {

/// What runs the cells of a plan, each after those of them that it needs.
class Engine {
 public:
  virtual ~Engine() = default;
  /// Begins with cells, in their order; what each says is appended to log_file(). Throws ConfigError where
  /// what it needs is not installed, and IoError.
  virtual void start(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells) = 0;
  /// Whether nothing runs any more.
  virtual bool ended() = 0;
  /// Asks what runs to stop, as Ctrl-C does; it then ends soon.
  virtual void stop() = 0;
};

/// Where a cell's output goes.
std::string log_file(const Plan& plan, const PlanPlace& place, const std::string& id);

/// Runs what is not finished of a plan, or of the cells that `only` names (cells_named) and what they need,
/// until it has ended; keeps results meanwhile where the place says so. Throws Interrupted once all have
/// stopped, Error naming a cell that failed and how many wait for others after the others have ended, and
/// ConfigError where there is no such cell.
void run_plan(const Plan& plan, const PlanPlace& place, Engine& engine, const std::string& label,
              const std::string& only = "");

/// The same as a run of `verb` in the plan's folder, which holds one plan with the same `settings` and rig:
/// the same call goes on where it was. It is finished once all cells are. Throws ConfigError, too, where the
/// folder holds something else, or one of the presets, the rig or the `inputs` (RunRequest) something else
/// than when it began. `prepare` is called once the folder is this run's, before any cell. Settings of which
/// no cell's work depends may differ (`free_keys`): they say which cells there are.
void run_plan_in_folder(
    const Plan& plan, const PlanPlace& place, Engine& engine, const std::string& verb, common::Json settings,
    const std::string& only, const std::function<void()>& prepare = [] {},
    std::map<std::string, std::string> inputs = {}, const std::vector<std::string>& free_keys = {});

/// Asks the process that runs a plan in this folder to stop, as Ctrl-C there would; on any machine that
/// shares the folder. Throws IoError.
void ask_to_stop(const std::string& folder);
/// Whether somebody has, since the plan's last start, and it had ended already.
bool asked_to_stop(const std::string& folder);

}  // namespace lodestone::runs
