#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/runs/compared_run.h"

namespace lodestone::runs {

/// A figure of two runs on the trials in which both have it. What is averaged, drawn anew and ranked are
/// units: rigs where several trials share one, else trials.
struct PairedFigure {
  static constexpr double kChance = 0.05;
  std::int64_t pairs = 0;  ///< trials
  std::int64_t units = 0;
  double first = 0.0, other = 0.0;      ///< means over the units
  double difference = 0.0;              ///< other minus first
  std::array<double, 2> interval = {};  ///< of the difference, 95 %, by drawing units anew
  double signed_rank_p = 1.0;           ///< of the units' differences, see common::signed_rank_p()

  /// Whether the other is larger, or smaller: the interval leaves zero out, and the rank test agrees at 5 %.
  /// The test is exact, while a bootstrap of few units gives intervals that are too narrow.
  bool larger() const { return interval[0] > 0.0 && signed_rank_p < kChance; }
  bool smaller() const { return interval[1] < 0.0 && signed_rank_p < kChance; }

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("pairs", pairs);
    v.field("units", units);
    v.field("first", first);
    v.field("other", other);
    v.field("difference", difference);
    v.field("interval", interval);
    v.field("signed_rank_p", signed_rank_p);
  }
};

/// One task on one kind of rig, by a run and by the one that all are held against. Failures stand apart from
/// errors, so that a needle that was given up early cannot pass for a close one.
struct ComparisonRow {
  std::string task, rig;
  std::int64_t other = 0;  ///< index of the run; 0 is the one it is held against
  bool rigs_are_units = false;
  bool one_rig = false;       ///< all trials are of the same rig: nothing is said of others
  std::int64_t left_out = 0;  ///< trials of either run that the other has not
  PairedFigure error_mm;      ///< TrialFigures::error_mm(), of all trials
  PairedFigure failed;        ///< 1 where a trial did not succeed
  PairedFigure stopped;       ///< 1 where it ended early
  std::optional<PairedFigure> error_of_successes_mm;  ///< where both succeeded
  std::optional<PairedFigure> seconds_to_reach;       ///< where both did
  std::optional<PairedFigure> completion;             ///< of paths
  std::vector<std::array<double, 2>> errors_mm;       ///< first, other: of every pair, in trial order
  std::string sentence;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("task", task);
    v.field("rig", rig);
    v.field("other", other);
    v.field("rigs_are_units", rigs_are_units);
    v.field("one_rig", one_rig);
    v.field("left_out", left_out);
    v.field("error_mm", error_mm);
    v.field("failed", failed);
    v.field("stopped", stopped);
    v.field("error_of_successes_mm", error_of_successes_mm);
    v.field("seconds_to_reach", seconds_to_reach);
    v.field("completion", completion);
    v.field("errors_mm", errors_mm);
    v.field("sentence", sentence);
  }
};

/// A key of the runs' configurations that has not the same value in all of them.
struct DifferentSetting {
  std::string key;
  std::vector<std::string> values;  ///< by run; empty: it has no such key
  /// Whether it changes what the trials are, and so may be what made the difference.
  bool of_the_trials = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("key", key);
    v.field("values", values);
    v.field("of_the_trials", of_the_trials);
  }
};

/// `comparison.json`: runs held against the first of them, trial by trial.
struct Comparison {
  static constexpr const char* kFile = "comparison.json";
  std::vector<std::string> runs;  ///< as they were asked for
  std::vector<std::string> controllers;
  std::vector<ComparisonRow> rows;
  std::vector<DifferentSetting> settings;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("runs", runs);
    v.field("controllers", controllers);
    v.field("rows", rows);
    v.field("settings", settings);
  }
};

/// Fewer units than this are too few for a sentence: no five differences reach 5 % in a rank test.
constexpr std::int64_t kLeastUnits = 6;

/// Pairs trials of the same task, kind of rig, number, start and target, or path. Throws ConfigError where
/// fewer than two runs are given, rigs are not shared alike, or a run shares no trial with the first.
Comparison compare_runs(const std::vector<ComparedRun>& runs);

}  // namespace lodestone::runs
