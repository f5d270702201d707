#pragma once

#include <cstdint>
#include <string>

namespace lodestone::exports {

/// What is in the log of a run: trials of a deployment, or episodes of a recording.
struct RunLogFacts {
  std::int64_t trials = 0, episodes = 0, steps = 0, images = 0;
};

/// Writes what a run of `deploy` has left in its folder as one log (RigLog): the trials one after another,
/// the first one from second 0 on and a second between two, with those that were cut short at the end. Poses,
/// targets, actions and currents are those of trajectories.csv; temperatures, and how a trial ended, those of
/// the run's trials; images those of its films, which show what was drawn on them. Of a run of `collect`, its
/// recording (log_recording). `file` is there in whole or not at all. Throws IoError, and DataError where the
/// folder holds no such run or a file of it is damaged.
RunLogFacts write_run_log(const std::string& run, const std::string& file);

}  // namespace lodestone::exports
