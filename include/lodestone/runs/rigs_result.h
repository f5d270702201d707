#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/runs/deployment_results.h"

namespace lodestone::runs {

/// What a controller drives with on many rigs.
constexpr std::array<const char*, 3> kControllers = {"planner", "policy", "baseline"};

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
  WorstRig worst;
  /// Its mean error minus the baseline's on the same trials; absent where the baseline did not drive.
  std::optional<double> minus_baseline_mm;
  std::optional<std::array<double, 2>> minus_baseline_interval_mm;

  template <class Visitor>
  void visit(Visitor& v) {
    TaskSummary::visit(v);
    v.field("mean_error_interval_mm", mean_error_interval_mm);
    v.field("success_interval", success_interval);
    v.field("time_rms_error_interval_mm", time_rms_error_interval_mm);
    v.field("corners_within_1_5_mm", corners_within_1_5_mm);
    v.field("corners_within_1_5_mm_interval", corners_within_1_5_mm_interval);
    v.field("worst", worst);
    v.field("minus_baseline_mm", minus_baseline_mm);
    v.field("minus_baseline_interval_mm", minus_baseline_interval_mm);
  }
};

/// `summary.json` of bench rigs.
struct RigsSummary {
  static constexpr const char* kFile = "summary.json";
  std::map<std::string, std::map<std::string, RigsTaskSummary>> by_controller;  ///< and task
  std::int64_t rigs = 0;
  std::int64_t trials_per_rig = 0;
  bool decorated = false;
  Provenance provenance;  ///< of the policy

  template <class Visitor>
  void visit(Visitor& v) {
    for (const char* controller : kControllers) v.entry(controller, by_controller);
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
