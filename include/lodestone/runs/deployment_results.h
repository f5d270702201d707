#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/runs/stitch_results.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::runs {

/// A list of TrialRecord, once a deployment has ended.
constexpr const char* kTrialsFile = "trials.json";

/// Tasks in the order of every table.
constexpr std::array<const char*, 7> kTasks = {"centre", "point", "pose",  "square",
                                               "circle", "path",  "suture"};

/// How well one trial went, by one source of positions.
struct TrialFigures {
  double final_error_mm = 0.0;  ///< distance to the target at the end
  bool success = false;
  std::optional<double> hold_error_mm;
  std::optional<double> heading_error_deg;
  /// Of sutures, and of paths that have headings: RMS error of the heading against that of the moving target.
  std::optional<double> heading_rms_deg;
  std::optional<double> cross_track_rms_mm;
  std::optional<double> time_rms_error_mm;    ///< paths: RMS distance to the moving reference
  std::optional<double> target_deviation_mm;  ///< the same as a mean: the paper's measure of a path (V-D)
  std::optional<double> completion;       ///< share of the reference's points reached in order and in time
  std::optional<double> corners_reached;  ///< share of the path's corners
  std::optional<std::vector<double>> corner_errors_mm;  ///< closest approach to each of them
  std::optional<double> frechet_mm;  ///< discrete Frechet distance between needle and reference
  /// Sutures: stitches that were made, and their share of all; the distance of the needle from the ends of
  /// the stitches where it was nearest, as RMS of all of them, and the largest; its largest heading error
  /// there.
  std::optional<std::int64_t> stitches_made;
  std::optional<double> stitches_made_share, stitch_rms_mm, stitch_worst_mm, stitch_worst_deg;
  std::optional<std::vector<StitchFigures>> stitch_figures;  ///< one by one
  std::optional<std::int64_t> steps_to_reach;
  std::optional<double> seconds_to_reach;
  /// Least distance of the needle from a zone that it must keep out of, at the moments that were observed: 0
  /// or less where it touched one; absent where there was none.
  std::optional<double> clearance_mm;
  std::optional<std::int64_t> touches;  ///< times that it came to touch one; with any the trial has failed
  /// How long the trial lasted, and what its pulses asked of all coils together: charge, and heat at their
  /// resistances at 20 C; absent in older runs.
  std::optional<double> duration_s, charge_As, heat_J;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("final_error_mm", final_error_mm);
    v.field("success", success);
    v.field("hold_error_mm", hold_error_mm);
    v.field("heading_error_deg", heading_error_deg);
    v.field("heading_rms_deg", heading_rms_deg);
    v.field("cross_track_rms_mm", cross_track_rms_mm);
    v.field("time_rms_error_mm", time_rms_error_mm);
    v.field("target_deviation_mm", target_deviation_mm);
    v.field("completion", completion);
    v.field("corners_reached", corners_reached);
    v.field("corner_errors_mm", corner_errors_mm);
    v.field("frechet_mm", frechet_mm);
    v.field("stitches_made", stitches_made);
    v.field("stitches_made_share", stitches_made_share);
    v.field("stitch_rms_mm", stitch_rms_mm);
    v.field("stitch_worst_mm", stitch_worst_mm);
    v.field("stitch_worst_deg", stitch_worst_deg);
    v.field("stitch_figures", stitch_figures);
    v.field("steps_to_reach", steps_to_reach);
    v.field("seconds_to_reach", seconds_to_reach);
    v.field("clearance_mm", clearance_mm);
    v.field("touches", touches);
    v.field("duration_s", duration_s);
    v.field("charge_As", charge_As);
    v.field("heat_J", heat_J);
  }
  /// The one error of a trial: of a path the cross-track RMS, of a suture the RMS at the ends of its
  /// stitches, of a point the distance at the end.
  double error_mm() const { return cross_track_rms_mm.value_or(stitch_rms_mm.value_or(final_error_mm)); }
};

using PointMm = std::array<double, 2>;  ///< x, y in mm
using PoseMm = std::array<double, 3>;   ///< x, y in mm, heading in rad
using DiscMm = std::array<double, 3>;   ///< x, y of its middle and its radius, in mm
using PerCoil = std::vector<double>;    ///< in the order of the rig's coils: +x, -x, +y, -y

/// One zone that the needle must keep out of.
struct ZoneRecord {
  std::string name;
  std::vector<PointMm> corners_mm;
  double radius_mm = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name);
    v.field("corners_mm", corners_mm);
    v.field("radius_mm", radius_mm);
  }
};

/// All of them, from an observation on.
struct ToldZonesRecord {
  double time_s = 0.0;
  std::vector<ZoneRecord> zones;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("time_s", time_s);
    v.field("zones", zones);
  }
};

/// One trial, as a line of trials.jsonl while a deployment runs, and in trials.json when it has ended.
struct TrialRecord {
  std::string task;
  std::string rig;         ///< "explored", "unseen" or "real"
  std::string controller;  ///< "policy", "planner" or "baseline"
  std::int64_t trial = 0;
  PoseMm start = {};
  std::optional<std::vector<PointMm>> path_mm;
  std::optional<std::vector<StitchRecord>> stitches;
  std::optional<PointMm> target_mm;
  std::optional<double> target_heading_rad;
  std::vector<double> time_s;                            ///< of every observation
  std::optional<std::vector<PoseMm>> trajectory;         ///< true poses; absent where nobody knows them
  std::vector<std::optional<PoseMm>> sensed_trajectory;  ///< null: no pose was found
  std::optional<std::vector<PointMm>> reference_mm;      ///< paths and sutures
  std::optional<std::vector<int>> approach;      ///< likewise: 1 on the way to the start, or to a stitch
  std::optional<std::vector<PointMm>> route_mm;  ///< points that the needle was sent to, one after another
  std::optional<std::vector<DiscMm>>
      obstacles_mm;  ///< that were drawn for this trial; absent where none were
  std::optional<std::vector<ToldZonesRecord>>
      told_zones;  ///< where a file tells them (safety.keep_out_file): at first, and whenever they were
                   ///< others
  std::optional<bool>
      unreachable;  ///< no way led past them: it was not driven; absent where none was searched
  std::optional<std::vector<PerCoil>> current_A;  ///< asked of the coils; absent in older runs
  /// Of sutures, and of paths that have headings: how the needle should have lain.
  std::optional<std::vector<double>> reference_heading_rad;
  /// As they reported last, null before; likewise.
  std::optional<std::vector<std::optional<PerCoil>>> temperature_C;
  /// Mean and standard deviation of what was identified, null where no pose was found; absent where nothing
  /// was.
  std::optional<std::vector<std::optional<std::array<double, 2>>>> log_drive_gain;
  /// When simulator and gain no longer explained what the pulses do; absent where they did.
  std::optional<double> rig_changed_s;
  /// From when on the camera no longer stood where it was calibrated, at first; absent where it did. There
  /// are no poses, and no pulses, while it does not.
  std::optional<double> camera_moved_s;
  std::optional<TrialFigures> truth;  ///< by true poses; absent likewise
  TrialFigures sensed;
  bool completed = false;
  std::string stop_reason;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("task", task);
    v.field("rig", rig);
    v.field("controller", controller);
    v.field("trial", trial);
    v.field("start", start);
    v.field("path_mm", path_mm);
    v.field("stitches", stitches);
    v.field("target_mm", target_mm);
    v.field("target_heading_rad", target_heading_rad);
    v.field("time_s", time_s);
    v.field("trajectory", trajectory);
    v.field("sensed_trajectory", sensed_trajectory);
    v.field("reference_mm", reference_mm);
    v.field("reference_heading_rad", reference_heading_rad);
    v.field("approach", approach);
    v.field("route_mm", route_mm);
    v.field("obstacles_mm", obstacles_mm);
    v.field("told_zones", told_zones);
    v.field("unreachable", unreachable);
    v.field("current_A", current_A);
    v.field("temperature_C", temperature_C);
    v.field("log_drive_gain", log_drive_gain);
    v.field("rig_changed_s", rig_changed_s);
    v.field("camera_moved_s", camera_moved_s);
    v.part("final_error_mm", truth);
    v.field("sensed", sensed);
    v.field("completed", completed);
    v.field("stop_reason", stop_reason);
  }
  /// Throws DataError when a list does not have as many rows as there are observations.
  void validate() const;
  /// By true poses where they are known, else as sensed.
  const TrialFigures& figures() const { return truth ? *truth : sensed; }
};

/// Errors of several trials by one source of positions: of the error_mm() of each, so that every trial counts
/// the same, and means over the trials that have a figure.
struct ErrorStatistics {
  double mean_error_mm = 0.0, std_error_mm = 0.0, median_error_mm = 0.0, rms_error_mm = 0.0;
  double success_rate = 0.0;
  std::optional<double> steps_to_reach, seconds_to_reach, hold_error_mm, heading_error_deg, heading_rms_deg,
      cross_track_rms_mm, time_rms_error_mm, target_deviation_mm, completion, corners_reached, frechet_mm;
  std::optional<double> stitches_made, stitches_made_share, stitch_rms_mm, stitch_worst_mm, stitch_worst_deg;
  /// Of the trials that had zones to keep out of: means, the least clearance of all, and the share of them in
  /// which the needle touched one with its 95 % interval (Wilson's).
  std::optional<double> clearance_mm, least_clearance_mm, touches, touching_rate;
  std::optional<std::array<double, 2>> touching_interval;
  std::optional<double> duration_s, charge_As, heat_J;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mean_error_mm", mean_error_mm);
    v.field("std_error_mm", std_error_mm);
    v.field("median_error_mm", median_error_mm);
    v.field("rms_error_mm", rms_error_mm);
    v.field("success_rate", success_rate);
    v.field("steps_to_reach", steps_to_reach);
    v.field("seconds_to_reach", seconds_to_reach);
    v.field("hold_error_mm", hold_error_mm);
    v.field("heading_error_deg", heading_error_deg);
    v.field("heading_rms_deg", heading_rms_deg);
    v.field("cross_track_rms_mm", cross_track_rms_mm);
    v.field("time_rms_error_mm", time_rms_error_mm);
    v.field("target_deviation_mm", target_deviation_mm);
    v.field("completion", completion);
    v.field("corners_reached", corners_reached);
    v.field("frechet_mm", frechet_mm);
    v.field("stitches_made", stitches_made);
    v.field("stitches_made_share", stitches_made_share);
    v.field("stitch_rms_mm", stitch_rms_mm);
    v.field("stitch_worst_mm", stitch_worst_mm);
    v.field("stitch_worst_deg", stitch_worst_deg);
    v.field("clearance_mm", clearance_mm);
    v.field("least_clearance_mm", least_clearance_mm);
    v.field("touches", touches);
    v.field("touching_rate", touching_rate);
    v.field("touching_interval", touching_interval);
    v.field("duration_s", duration_s);
    v.field("charge_As", charge_As);
    v.field("heat_J", heat_J);
  }
};

/// One task by one controller on one kind of rig.
struct TaskSummary {
  std::int64_t n_trials = 0;
  std::int64_t stopped = 0;  ///< trials that ended early; they count as failed
  /// Trials in which the rig was told to be another than simulator and gain describe; absent in older runs.
  std::optional<std::int64_t> rig_changed;
  /// Trials whose obstacles left no way to the target, counted as stopped, too; absent where none was
  /// searched.
  std::optional<std::int64_t> unreachable;
  std::optional<ErrorStatistics> truth;  ///< against true poses; absent where nobody knows them
  ErrorStatistics sensed;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("n_trials", n_trials);
    v.field("stopped", stopped);
    v.field("rig_changed", rig_changed);
    v.field("unreachable", unreachable);
    v.part("mean_error_mm", truth);
    v.field("sensed", sensed);
  }
};

/// `reachable.json`: where the needle can be brought, in which ways to a point were searched.
struct ReachMap {
  static constexpr const char* kFile = "reachable.json";
  double cell_mm = 0.0;               ///< side of a square cell
  std::vector<PointMm> reachable_mm;  ///< middles of the cells that it comes to and gets away from
  std::vector<PointMm>
      dead_mm;  ///< of all others that pulses came to: dead zones, and what was seldom visited

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("cell_mm", cell_mm);
    v.field("reachable_mm", reachable_mm);
    v.field("dead_mm", dead_mm);
  }
};

/// What one controller did, by task.
struct TaskTable {
  std::map<std::string, TaskSummary> by_task;

  template <class Visitor>
  void visit(Visitor& v) {
    for (const char* task : kTasks) v.entry(task, by_task);
  }
};

/// The trials of a folder that deploy wrote; nothing where there are none. Throws DataError naming a damaged
/// file.
std::optional<std::vector<TrialRecord>> find_trials(const std::string& folder);

/// One kind of rig: the tasks of what was asked for, and under "baseline" what it is held against.
struct RigSummary {
  std::optional<std::string> controller;  ///< "policy" or "planner"; absent where only the baseline drove
  TaskTable tasks;
  std::optional<TaskTable> baseline;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("controller", controller);
    tasks.visit(v);
    v.field("baseline", baseline);
  }
};

/// `summary.json` of deploy: the first kind of rig at the top, each below its name where there are two, and
/// what made the policy. The report merges the whole run's into one.
struct DeploymentSummary : RigSummary {
  static constexpr const char* kFile = "summary.json";
  std::map<std::string, RigSummary> by_rig;  ///< "explored" and "unseen", where both were driven
  std::optional<std::string> scored_by;      ///< "camera" on a real rig, where nobody knows the true pose
  std::optional<std::string> stopped;        ///< why the rig was stopped for good
  Provenance provenance;

  template <class Visitor>
  void visit(Visitor& v) {
    RigSummary::visit(v);
    for (const char* rig : {"explored", "unseen"}) v.entry(rig, by_rig);
    v.field("scored_by", scored_by);
    v.field("stopped", stopped);
    provenance.visit(v);
  }
};

}  // namespace lodestone::runs
