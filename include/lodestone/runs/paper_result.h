#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "lodestone/common/config.h"

namespace lodestone::runs {

/// Errors of one task under one controller, pooled over training seeds: the distance at the end of a trial,
/// or the cross-track RMS of one. Intervals are 95 %. What only paths have, as means over the trials, is
/// absent for points.
struct PooledErrors {
  double mean_error_mm = 0.0, std_error_mm = 0.0, rms_error_mm = 0.0;
  double iqm_error_mm = 0.0;  ///< interquartile mean
  std::array<double, 2> iqm_interval_mm = {};
  double success_rate = 0.0;
  std::array<double, 2> success_interval = {};
  std::optional<double> target_deviation_mm, target_deviation_std_mm;  ///< the paper's measure of a path
  std::optional<double> time_rms_error_mm, completion, corners_reached, frechet_mm;
  std::int64_t n_trials = 0, n_seeds = 0, n_stopped = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mean_error_mm", mean_error_mm);
    v.field("std_error_mm", std_error_mm);
    v.field("rms_error_mm", rms_error_mm);
    v.field("iqm_error_mm", iqm_error_mm);
    v.field("iqm_interval_mm", iqm_interval_mm);
    v.field("success_rate", success_rate);
    v.field("success_interval", success_interval);
    v.field("target_deviation_mm", target_deviation_mm);
    v.field("target_deviation_std_mm", target_deviation_std_mm);
    v.field("time_rms_error_mm", time_rms_error_mm);
    v.field("completion", completion);
    v.field("corners_reached", corners_reached);
    v.field("frechet_mm", frechet_mm);
    v.field("n_trials", n_trials);
    v.field("n_seeds", n_seeds);
    v.field("n_stopped", n_stopped);
  }
};

/// Time of learning, mean over training seeds (Table I).
struct PooledTraining {
  double seconds_to_95_percent = 0.0, train_seconds = 0.0;
  std::int64_t n_seeds = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seconds_to_95_percent", seconds_to_95_percent);
    v.field("train_seconds", train_seconds);
    v.field("n_seeds", n_seeds);
  }
};

/// A mix with recorded steps (Fig. 5), mean over training seeds.
struct PooledMix {
  double final_return = 0.0, success_rate = 0.0;
  std::int64_t n_seeds = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("final_return", final_return);
    v.field("success_rate", success_rate);
    v.field("n_seeds", n_seeds);
  }
};

/// `report.json` of the paper's experiments.
struct PaperResult {
  static constexpr const char* kFile = "report.json";
  std::string scale;
  common::Json machine;
  std::map<std::string, std::map<std::string, PooledErrors>> transfer;    ///< row, task
  std::map<std::string, std::map<std::string, PooledTraining>> training;  ///< row, task
  std::map<std::string, PooledMix> mixes;  ///< environments that replay, or "offline"
  std::map<std::string, std::map<std::string, PooledErrors>> ablations;  ///< name, task

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("scale", scale);
    v.field("machine", machine);
    v.field("transfer", transfer);
    v.field("training", training);
    v.field("mixes", mixes);
    v.field("ablations", ablations);
  }
};

}  // namespace lodestone::runs
