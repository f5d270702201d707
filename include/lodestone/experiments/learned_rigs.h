#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/experiments/adaptation_run.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/experiments/trial_driver.h"
#include "lodestone/runs/rigs_result.h"

namespace lodestone::experiments {

/// A planner that learns each rig from pulses of its own before it drives there.
struct RigLearner {
  std::int64_t pulses = 0;    ///< on every rig
  bool from_scratch = false;  ///< or from the simulator that is named on

  /// As a controller of a bench: "adapted_1000", "from_scratch_3000".
  std::string name() const;
};

/// How it learns the rig of these trials; its adaptation lies in a folder for each rig below the bench's.
AdaptationConfig adaptation_of(const RigLearner& learner, const DeployConfig& config, std::int64_t rig);
std::string adaptation_folder(const RigLearner& learner, const std::string& folder, std::int64_t rig);

/// Drives what others drive as `driver` does, and the trials of a learner in what was learned of their rig,
/// which it learns first where nobody has. A driver's trials share rigs (trials.per_rig). Throws what
/// AdaptationRun throws.
TrialDriver learning_driver(TrialDriver driver, const std::vector<RigLearner>& learners,
                            const DeployConfig& config, const std::string& folder);

/// What came of the rigs that were learned so far.
runs::LearnedRigs summarise_learned(const RigLearner& learner, const std::string& folder, std::int64_t rigs);

}  // namespace lodestone::experiments
