#pragma once

#include <fstream>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/experiments/trial.h"

namespace lodestone::experiments {

/// Writes every step of every trial as one CSV line, flushed after each trial. Columns carry their units.
class Recorder {
 public:
  /// Throws IoError when the file cannot be opened.
  explicit Recorder(const std::string& file);
  /// Throws IoError when the disk is full.
  void write(const TrialResult& result);

 private:
  std::string path_;
  std::ofstream file_;
};

/// One entry of trials.json: task, controller, trial, start, target_mm or path_mm, trajectory and
/// sensed_trajectory as [x_mm, y_mm, heading_rad] per observation, reference_mm, errors in mm, success.
common::Json trial_to_json(const TrialResult& result);

}  // namespace lodestone::experiments
