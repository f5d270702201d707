#pragma once

#include <memory>
#include <optional>

#include "lodestone/env/vec_env.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/rl/policy_trainer.h"

namespace lodestone::rl {

/// What a policy is trained in, and where it is scored: same rules, random streams of their own.
struct PolicyEnvironments {
  /// training.environments copies, some of which may play back; null where the learner steps its own needles.
  std::unique_ptr<env::VecEnv> training;
  std::unique_ptr<env::VecEnv> evaluation;  ///< training.evaluation_episodes copies, to choose by
  std::unique_ptr<env::VecEnv> fresh;       ///< as many, which nothing is chosen by
  std::optional<inference::DynamicsModel> dynamics;
  std::shared_ptr<const task::Region> region;  ///< that starts and goals lie in; null: the whole discs
};

/// Builds what `config` asks for, and fills in what adopt_rig and adopt_data take from the rig and the
/// dynamics' training data. The plain simulator needs no dynamics; when one is named, its data still give
/// scale and workspace. Throws ConfigError, CheckpointError, DataError.
PolicyEnvironments make_policy_environments(TrainPolicyConfig& config);

/// The learner that `config` asks for, in these environments, which must outlive it. Throws ConfigError.
std::unique_ptr<PolicyLearner> make_policy_learner(const TrainPolicyConfig& config,
                                                   const PolicyEnvironments& environments);
/// train_policy() with that learner.
runs::PolicyResult train_policy(const TrainPolicyConfig& config, const PolicyEnvironments& environments,
                                runs::RunFolder& run);

}  // namespace lodestone::rl
