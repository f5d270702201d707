#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "lodestone/experiments/trial.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::experiments {

/// Writes every step of every trial as one CSV line, flushed after each trial. Columns carry their units;
/// what is not known is empty, and
/// true poses are no columns where nobody knows them.
class Recorder {
 public:
  /// Begins the file, or goes on with it after the first `keep_rows` rows; throws IoError when it cannot be
  /// written.
  Recorder(const std::string& file, bool true_poses, std::int64_t keep_rows = 0);
  /// Throws IoError when the disk is full.
  void write(const TrialResult& result);

 private:
  std::string path_;
  bool true_poses_;
  std::ofstream file_;
};

/// What is kept of a trial, in mm and degrees.
runs::TrialRecord record_of(const TrialResult& result);

}  // namespace lodestone::experiments
