#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::runs {

/// One side of a comparison: what one controller did in a folder of deploy or bench rigs.
struct ComparedRun {
  std::string name;  ///< as it was asked for
  std::string folder;
  std::string controller;
  std::int64_t per_rig = 0;  ///< trials that share each unseen rig; 0: each has one of its own
  common::Json config;       ///< what the run was told
  std::vector<TrialRecord> trials;
};

/// Reads "FOLDER" or "FOLDER:CONTROLLER": a folder that deploy or bench rigs wrote, or a run's that holds
/// deploy's as `deploy`. Without a controller it is the one besides the baseline, or the only one. Throws
/// ConfigError where there is no such folder or controller, or several to choose from, and DataError where
/// the trials have not all been driven or are damaged.
ComparedRun read_compared_run(const std::string& text);

}  // namespace lodestone::runs
