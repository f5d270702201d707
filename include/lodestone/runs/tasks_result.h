#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "lodestone/runs/deployment_results.h"

namespace lodestone::runs {

/// What drives in bench tasks beside the controllers, to tell what can be reached (experiments/oracle.h).
constexpr const char* kOracle = "oracle";
constexpr std::array<const char*, 5> kDrivers = {"planner", "policy", "baseline", "observer", kOracle};

/// One task by one controller, bare or decorated. Intervals cover 95 %: Wilson's of shares, else by drawing
/// trials anew, each of which is on a rig of its own.
struct TaskFigures : TaskSummary {
  std::array<double, 2> success_interval = {};
  std::array<double, 2> mean_error_interval_mm = {}, rms_error_interval_mm = {};
  std::optional<std::array<double, 2>> time_rms_error_interval_mm;  ///< of paths,
  std::optional<std::array<double, 2>> heading_rms_interval_deg;    ///< of those that have headings,
  std::optional<std::array<double, 2>> heading_error_interval_deg;  ///< and of poses
  /// Of trials with obstacles of their own: the share of layouts without any way, and the successes among the
  /// others; the latter is absent where there are none.
  std::optional<double> unreachable_rate, reachable_success_rate;
  std::optional<std::array<double, 2>> unreachable_interval, reachable_success_interval;
  /// Its mean error over that of the same controller in fluid at rest, over the baseline's, and over the
  /// oracle's, on the same trials (the first ones, where one drove more); absent where those were not driven.
  std::optional<double> ratio_to_still, ratio_to_baseline, ratio_to_oracle;
  std::optional<std::array<double, 2>> ratio_to_still_interval, ratio_to_baseline_interval,
      ratio_to_oracle_interval;

  template <class Visitor>
  void visit(Visitor& v) {
    TaskSummary::visit(v);
    v.field("success_interval", success_interval);
    v.field("mean_error_interval_mm", mean_error_interval_mm);
    v.field("rms_error_interval_mm", rms_error_interval_mm);
    v.field("time_rms_error_interval_mm", time_rms_error_interval_mm);
    v.field("heading_rms_interval_deg", heading_rms_interval_deg);
    v.field("heading_error_interval_deg", heading_error_interval_deg);
    v.field("unreachable_rate", unreachable_rate);
    v.field("unreachable_interval", unreachable_interval);
    v.field("reachable_success_rate", reachable_success_rate);
    v.field("reachable_success_interval", reachable_success_interval);
    v.field("ratio_to_still", ratio_to_still);
    v.field("ratio_to_still_interval", ratio_to_still_interval);
    v.field("ratio_to_baseline", ratio_to_baseline);
    v.field("ratio_to_baseline_interval", ratio_to_baseline_interval);
    v.field("ratio_to_oracle", ratio_to_oracle);
    v.field("ratio_to_oracle_interval", ratio_to_oracle_interval);
  }
  /// By true poses where they are known, else as sensed.
  const ErrorStatistics& errors() const { return truth ? *truth : sensed; }
};

/// Who drove a task, by name, and below it "bare" or "decorated".
using TaskDrivers = std::map<std::string, std::map<std::string, TaskFigures>>;

/// `summary.json` of bench tasks.
struct TasksSummary {
  static constexpr const char* kFile = "summary.json";
  /// Tasks that stand alone, and those of which there are several of a kind.
  static constexpr std::array<const char*, 4> kAlone = {"pose", "pose_wide", "suture", "obstacles"};
  static constexpr std::array<const char*, 4> kGroups = {"tangent_path", "flow", "still", "square_at_mm_s"};

  std::map<std::string, TaskDrivers> alone;
  std::map<std::string, std::map<std::string, TaskDrivers>> groups;
  std::optional<double> flow_speed_m_s;  ///< of the flow that pulses, in the mean over a period
  /// experiments::square_speed_limit_m_s() of the rig's description, for squares and periods as by default.
  std::optional<double> square_speed_limit_m_s;
  std::int64_t cells = 0;          ///< that are finished,
  std::int64_t cells_planned = 0;  ///< of so many

  template <class Visitor>
  void visit(Visitor& v) {
    for (const char* task : kAlone) v.entry(task, alone);
    for (const char* group : kGroups) v.entry(group, groups);
    v.field("flow_speed_m_s", flow_speed_m_s);
    v.field("square_speed_limit_m_s", square_speed_limit_m_s);
    v.field("cells", cells);
    v.field("cells_planned", cells_planned);
  }
};

}  // namespace lodestone::runs
