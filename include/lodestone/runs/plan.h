#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/runs/run_folder.h"

namespace lodestone::runs {

/// One run of one verb, in a folder of its own. {ID} in a setting stands for the folder of another cell,
/// which it then needs.
struct Cell {
  std::string id;  ///< also its folder
  std::string verb;
  std::string config;                 ///< preset under configs/, or a file by its whole path; empty: none
  std::vector<std::string> settings;  ///< key=value
  std::optional<std::int64_t> seed;   ///< without: the plan's
  std::int64_t seed_offset = 0;       ///< added to it
  bool all_threads = false;           ///< takes every processor
  std::int64_t drawn_trials = 0;      ///< so many of its trials' trajectories stay in its record
  std::optional<std::int64_t> memory_mb, minutes;  ///< most it takes, for a cluster; without: the plan's

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("id", id);
    v.field("verb", verb);
    v.field("config", config);
    v.field("settings", settings);
    v.field("seed", seed);
    v.field("seed_offset", seed_offset);
    v.field("all_threads", all_threads);
    v.field("drawn_trials", drawn_trials);
    v.field("memory_mb", memory_mb);
    v.field("minutes", minutes);
  }
  /// Ids in its settings, in order.
  std::vector<std::string> needs() const;
};

/// A cell may run verbs that write a run into --out and go on with it. Throws ConfigError for another; `what`
/// begins its message.
void check_verb(const std::string& verb, const std::string& what);

/// Runs that need each other: the experiments of the paper, the steps of the quickstart, or a sweep of the
/// user's.
struct Plan {
  std::vector<Cell> cells;
  std::string name;  ///< for people
  std::int64_t seed = 1;
  std::string subfolder;  ///< of the plan's folder that the cells' folders lie in; empty: directly in it
  bool keep_checkpoints = true;  ///< else what only training on would need goes when a cell is finished
  std::optional<std::int64_t> memory_mb, minutes;  ///< of a cell that says none; without: the cluster's way

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name);
    v.field("seed", seed);
    v.field("subfolder", subfolder);
    v.field("keep_checkpoints", keep_checkpoints);
    v.field("memory_mb", memory_mb);
    v.field("minutes", minutes);
    v.field("cells", cells);
  }
  /// Throws ConfigError: no cell, two of one id, a need that is no cell or comes later, a verb that cannot be
  /// a cell, a limit that leaves no room.
  void validate() const;
  const Cell* find(const std::string& id) const;
};

/// Reads a plan; keys of cells that are not given have their defaults. Throws ConfigError and DataError.
Plan read_plan(const std::string& path);

/// Where a plan is run, and with what.
struct PlanPlace {
  std::string folder;
  std::string program;        ///< path of lodestone
  std::string configs;        ///< folder of the presets
  std::string rig_file = "";  ///< of every cell; empty: the paper's rig
  std::int64_t threads = 1;
  std::string results = "";  ///< where finished cells are kept (KeptResults); empty: nowhere
  /// Arguments of the program, once no cell runs any more: for engines whose cells outlive this process.
  std::vector<std::string> last_command = {};
  std::int64_t cell_threads = 1;  ///< of each cell that does not take all
};

/// The file of a cell's preset.
std::string preset_file(const PlanPlace& place, const Cell& cell);
std::string cell_folder(const Plan& plan, const PlanPlace& place, const std::string& id);
/// The command line of a cell, without the program. It goes on with what was interrupted and finds what is
/// finished.
std::vector<std::string> cell_arguments(const Plan& plan, const PlanPlace& place, const Cell& cell);

/// How far one run is.
struct StatusRow {
  std::string name;               ///< id of the cell, or the folder
  std::optional<RunState> state;  ///< absent: not begun
  bool running = false;           ///< a process works on it right now
  std::string path = {};          ///< its folder
  std::string waits_for = {};     ///< the first cell that it needs and that has not finished
  std::string failure = {};       ///< what a cell said last that nobody works on and that waits for none
};

/// The last line of what a cell said; a text about that where there is none.
std::string last_said(const std::string& log);

/// The run in a folder, the cells of the plan in it, or all runs below it. Throws DataError where one is
/// damaged, and ConfigError where there is none.
std::vector<StatusRow> status_of(const std::string& folder);

/// Says in the folder which plan is run there, for status_of() and find_plan().
void write_plan(const Plan& plan, const std::string& folder);
/// Throws ConfigError where none is run there.
Plan find_plan(const std::string& folder);
/// Whether there is one.
bool holds_plan(const std::string& folder);

}  // namespace lodestone::runs
