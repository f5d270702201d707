#pragma once

#include <memory>

#include "lodestone/env/vec_env.h"
#include "lodestone/rl/policy_trainer.h"

namespace lodestone::rl {

/// Where a policy is trained, and where it is scored: same rules, random streams of their own.
struct PolicyEnvironments {
  std::unique_ptr<env::VecEnv> training;       ///< training.environments copies, some of which may play back
  std::unique_ptr<env::VecEnv> evaluation;     ///< training.evaluation_episodes copies
  std::shared_ptr<const task::Region> region;  ///< that starts and goals lie in; null: the whole discs
};

/// Builds what `config` asks for, and fills in what adopt_rig and adopt_data take from the rig and the
/// dynamics' training data. The plain simulator needs no dynamics; when one is named, its data still give
/// scale and workspace. Throws ConfigError, CheckpointError, DataError.
PolicyEnvironments make_policy_environments(TrainPolicyConfig& config);

}  // namespace lodestone::rl
