#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/runs/deployment_results.h"

namespace lodestone::runs {

/// What a controller drives with on many rigs.
constexpr std::array<const char*, 4> kControllers = {"planner", "policy", "baseline", "observer"};

/// The rig on which a controller did worst at a task.
struct WorstRig {
  std::int64_t rig = 0;
  double mean_error_mm = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("rig", rig);
    v.field("mean_error_mm", mean_error_mm);
  }
};

/// One task by one controller on many rigs. Intervals cover 95 % and come from drawing rigs anew, as trials
/// on one rig are alike.
struct RigsTaskSummary : TaskSummary {
  std::array<double, 2> mean_error_interval_mm = {}, success_interval = {};
  std::optional<std::array<double, 2>> time_rms_error_interval_mm;
  std::optional<double> corners_within_1_5_mm;  ///< share of the corners approached so closely
  std::optional<std::array<double, 2>> corners_within_1_5_mm_interval;
  std::optional<std::array<double, 2>> heading_rms_interval_deg;  ///< of paths that have headings
  WorstRig worst;
  /// Its mean error minus the baseline's on the same trials; absent where the baseline did not drive.
  std::optional<double> minus_baseline_mm;
  std::optional<std::array<double, 2>> minus_baseline_interval_mm;
  /// The same against the planner that only identifies its rigs, of planners that learned theirs.
  std::optional<double> minus_planner_mm;
  std::optional<std::array<double, 2>> minus_planner_interval_mm;

  template <class Visitor>
  void visit(Visitor& v) {
    TaskSummary::visit(v);
    v.field("mean_error_interval_mm", mean_error_interval_mm);
    v.field("success_interval", success_interval);
    v.field("time_rms_error_interval_mm", time_rms_error_interval_mm);
    v.field("corners_within_1_5_mm", corners_within_1_5_mm);
    v.field("corners_within_1_5_mm_interval", corners_within_1_5_mm_interval);
    v.field("heading_rms_interval_deg", heading_rms_interval_deg);
    v.field("worst", worst);
    v.field("minus_baseline_mm", minus_baseline_mm);
    v.field("minus_baseline_interval_mm", minus_baseline_interval_mm);
    v.field("minus_planner_mm", minus_planner_mm);
    v.field("minus_planner_interval_mm", minus_planner_interval_mm);
  }
};

/// What a planner learned from pulses on each rig before it drove there.
struct LearnedRigs {
  std::int64_t pulses = 0;      ///< on each
  double rig_minutes = 0.0;     ///< that they take
  std::int64_t rigs = 0;        ///< that were learned so far
  std::int64_t kept = 0;        ///< rigs on which what was learned explains more than the rig's gain does
  std::int64_t placements = 0;  ///< of the needle by the operator, on all of them
  double median_seconds = 0.0;  ///< of computing for a rig, driving it included

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("pulses", pulses);
    v.field("rig_minutes", rig_minutes);
    v.field("rigs", rigs);
    v.field("kept", kept);
    v.field("placements", placements);
    v.field("median_seconds", median_seconds);
  }
};

/// `summary.json` of bench rigs.
struct RigsSummary {
  static constexpr const char* kFile = "summary.json";
  std::map<std::string, std::map<std::string, RigsTaskSummary>> by_controller;  ///< and task
  std::int64_t rigs = 0;
  std::int64_t trials_per_rig = 0;
  bool decorated = false;
  std::map<std::string, LearnedRigs> learned;  ///< by the name of the planner that learned
  Provenance provenance;                       ///< of the policy

  /// Who drove: planners first, those that learned more after those that learned less.
  std::vector<std::string> controllers() const {
    std::vector<std::string> names(kControllers.begin(), kControllers.end());
    std::set<std::pair<std::int64_t, std::string>> learners;
    for (const auto& [name, rigs_learned] : learned) learners.emplace(rigs_learned.pulses, name);
    auto after = names.begin() + 1;
    for (const auto& [pulses, name] : learners) after = names.insert(after, name) + 1;
    return names;
  }

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("learned", learned);
    for (const std::string& controller : controllers()) v.entry(controller.c_str(), by_controller);
    v.field("rigs", rigs);
    v.field("trials_per_rig", trials_per_rig);
    v.field("decorated", decorated);
    v.field("provenance", provenance);
  }
};

/// What was hidden in a rig, as factors on its description, and the mean error of each controller at each
/// task.
struct RigFigures {
  double moment = 1.0, friction = 1.0, viscosity = 1.0;
  std::optional<double> weight;  ///< absent in older runs
  double coil_gain = 1.0;        ///< mean over the coils
  std::map<std::string, std::map<std::string, double>> mean_error_mm;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("moment", moment);
    v.field("friction", friction);
    v.field("viscosity", viscosity);
    v.field("weight", weight);
    v.field("coil_gain", coil_gain);
    v.field("mean_error_mm", mean_error_mm);
  }
};

/// `rigs.json` of bench rigs.
struct RigsResult {
  static constexpr const char* kFile = "rigs.json";
  std::vector<RigFigures> rigs;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("rigs", rigs);
  }
};

}  // namespace lodestone::runs
