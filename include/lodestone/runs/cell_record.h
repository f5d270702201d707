#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/data/mobility.h"
#include "lodestone/runs/deployment_results.h"
#include "lodestone/runs/plan.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::runs {

/// Evaluations of a training run, one entry each.
struct KeptCurve {
  std::vector<double> env_steps, episode_return, success_rate;
  std::vector<double> seconds, processor_seconds;  ///< of learning, so far

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("env_steps", env_steps);
    v.field("episode_return", episode_return);
    v.field("success_rate", success_rate);
    v.field("seconds", seconds);
    v.field("processor_seconds", processor_seconds);
  }
};

/// Trials of one task by one controller, one entry each; what only paths have is empty for points.
struct KeptTrials {
  std::string task, controller;
  std::vector<double> error_mm;  ///< TrialFigures::error_mm()
  std::vector<int> success, stopped;
  std::vector<double> target_deviation_mm, time_rms_error_mm, completion, corners_reached, frechet_mm;
  std::vector<TrialRecord> drawn;  ///< the first ones, as far as they can be drawn

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("task", task);
    v.field("controller", controller);
    v.field("error_mm", error_mm);
    v.field("success", success);
    v.field("stopped", stopped);
    v.field("target_deviation_mm", target_deviation_mm);
    v.field("time_rms_error_mm", time_rms_error_mm);
    v.field("completion", completion);
    v.field("corners_reached", corners_reached);
    v.field("frechet_mm", frechet_mm);
    v.field("drawn", drawn);
  }
};

/// A finished cell in a few kilobytes: what it was asked, where and when it was run, and what a page says of
/// it.
struct CellRecord {
  std::string verb;
  std::vector<std::string> settings;
  std::int64_t seed = 0;
  common::Json preset;   ///< content of the cell's preset at that time; null: none
  common::Json machine;  ///< manifest of the run without the machine's name: commit, processor, threads, date
  double seconds = 0.0;  ///< of work, interruptions left out
  std::optional<CollectionFacts> collected;
  std::optional<data::Mobility> mobility;  ///< of collect
  std::optional<DynamicsEvaluation> dynamics;
  std::optional<PolicyResult> policy;
  std::optional<KeptCurve> curve;  ///< of train-policy
  std::optional<KeptTrials> trials;

  /// What its manifest says under a key ("git_commit", "processor"), each text once, in the order in which
  /// the run was worked on; "unknown" where that is not said.
  std::vector<std::string> manifest_texts(const std::string& key) const;
  /// Most that worked on it at a time; 1 where that is not said.
  std::int64_t threads() const;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("verb", verb);
    v.field("settings", settings);
    v.field("seed", seed);
    v.field("preset", preset);
    v.field("machine", machine);
    v.field("seconds", seconds);
    v.field("collected", collected);
    v.field("mobility", mobility);
    v.field("dynamics", dynamics);
    v.field("policy", policy);
    v.field("curve", curve);
    v.field("trials", trials);
  }
};

/// The record of a cell that is finished in its folder. Throws DataError where a file of the run is damaged.
CellRecord record_of(const Plan& plan, const PlanPlace& place, const Cell& cell);

/// Content of a cell's preset; null where it has none. Throws DataError where the file is damaged.
common::Json preset_of(const PlanPlace& place, const Cell& cell);

/// Whether a run with this configuration (config.json) is one of a cell with this preset and its settings: a
/// folder may hold what was run before they were changed.
bool is_run_of(const common::Json& config, const Cell& cell, const common::Json& preset);

/// Whether it is of a cell with the same verb, settings, seed and content of its preset.
bool is_record_of(const CellRecord& record, const Plan& plan, const Cell& cell, const common::Json& preset);

}  // namespace lodestone::runs
