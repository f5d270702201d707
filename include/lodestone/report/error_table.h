#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/statistics.h"
#include "lodestone/report/run_data.h"

namespace lodestone::report {

/// One line of the error table: a task driven by something on some rig.
struct ErrorRow {
  std::string task;        ///< one of runs::kTasks
  std::string controller;  ///< "policy", "planner", "baseline", or what the paper calls it
  std::string rig;         ///< "explored", "unseen", "real", or "paper"
  std::optional<double> mean_mm = {}, std_mm = {}, median_mm = {}, rms_mm = {};
  std::optional<double> sensed_mean_mm = {}, sensed_std_mm = {};
  std::optional<double> target_deviation_mm = {}, target_deviation_std_mm = {};
  std::optional<double> completion = {}, corners_reached = {}, time_rms_mm = {}, frechet_mm = {};
  std::optional<double> heading_rms_deg = {};  ///< of sutures, and of paths that have headings
  std::optional<double> stitches_made = {}, stitches_made_share = {}, stitch_worst_mm = {},
                        stitch_worst_deg = {};  ///< of sutures
  /// Of trials with zones to keep out of: mean and least clearance, and the share that touched one, with its
  /// 95 % interval.
  std::optional<double> clearance_mm = {}, least_clearance_mm = {}, touching_rate = {};
  std::optional<common::Interval> touching_interval = {};
  std::optional<double> unreachable = {};  ///< trials whose own obstacles left no way to the target
  std::optional<double> hold_mm = {}, seconds_to_reach = {}, success_rate = {}, trials = {}, stopped = {};
  std::optional<double> duration_s = {}, charge_As = {}, heat_J = {};
  /// 95 %: bootstrap over the trials, each with its RMS error; Wilson's of the fraction of successes.
  std::optional<common::Interval> rms_interval_mm = {}, success_interval = {};
  /// 95 %: bootstrap of the mean over the trials.
  std::optional<common::Interval> heading_rms_interval_deg = {};
  bool published = false;  ///< from Table II of the paper
};

/// Task by task: the paper's Table II first, then what this run measured. The paper's figure of the square is
/// a deviation from the targets, ours beside it likewise.
std::vector<ErrorRow> error_rows(const RunData& run);

/// The same as plain text, for terminals.
std::string error_table_text(const std::vector<ErrorRow>& rows);

/// The run in numbers: the tasks on the explored rig, `explored` and `unseen` in full, dynamics, policy and
/// collect. Parts that are missing are left out.
runs::DeploymentSummary merged_summary(const RunData& run);

}  // namespace lodestone::report
