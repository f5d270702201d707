#pragma once

#include "lodestone/common/metrics.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/inference/actor_critic.h"
#include "lodestone/runs/training_results.h"
#include "lodestone/task/observation.h"

namespace lodestone::rl {

using runs::PolicyScore;

/// An action component beyond this, in [-1, 1], counts as saturated.
constexpr float kSaturatedAction = 0.95F;

/// Under the keys evaluation/...
common::Scalars scalars_of(const PolicyScore& score);

/// The same starts, goals and disturbances every time: the state of the environments at construction is taken
/// up again before each evaluation. `environments` must be apart from those of training (own seed), and
/// outlive this.
class PolicyEvaluation {
 public:
  PolicyEvaluation(env::VecEnv& environments, const task::EncoderConfig& encoder);
  PolicyScore run(const inference::Actor& policy);

 private:
  env::VecEnv& environments_;
  task::ObservationEncoder encoder_;
  env::Snapshot start_;
};

}  // namespace lodestone::rl
