#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "lodestone/experiments/trial.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::experiments {

/// Writes every step of every trial as one CSV line. Columns carry their units; what is not known is empty,
/// and true poses are no columns where nobody knows them.
class Recorder {
 public:
  /// Begins the file, or goes on with it after the first `keep_rows` rows. What a real rig has left behind
  /// them, in a trial that was cut short, goes to a file of its own (..._cut_short.csv); on a virtual one the
  /// trial is driven again as it was. `coils`: what the columns of their currents call them. Throws IoError,
  /// and DataError when there are fewer rows.
  Recorder(const std::string& file, bool true_poses, std::int64_t keep_rows = 0,
           const std::vector<std::string>& coils = {"px", "mx", "py", "my"}, int action_size = 2);
  /// A step of a trial that is under way, which is on its way to the disk when this returns. Throws IoError.
  void write(const TrialPlan& plan, const std::string& rig, const std::string& controller,
             const TrialSample& sample);
  /// A trial that has ended, from a sample on. Throws IoError.
  void write(const TrialResult& result, std::size_t first_sample = 0);
  /// Everything written has reached the disk. Throws IoError.
  void sync();

 private:
  void write_row(const TrialPlan& plan, const std::string& rig, const std::string& controller,
                 const TrialSample& sample);
  void flush();

  std::string path_;
  bool true_poses_;
  std::ofstream file_;
};

/// What is kept of a trial, in mm and degrees.
runs::TrialRecord record_of(const TrialResult& result);

}  // namespace lodestone::experiments
