#pragma once

#include <cstdint>

#include "lodestone/common/config.h"
#include "lodestone/common/metrics.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/inference/actor_critic.h"
#include "lodestone/task/observation.h"

namespace lodestone::rl {

/// Figures of the deterministic policy over one episode per environment.
struct PolicyScore {
  double episode_return = 0.0;
  double success_rate = 0.0;    ///< fraction of episodes that were within the success radius at some step
  double final_error_mm = 0.0;  ///< mean distance to the goal when the episode ended
  double final_error_median_mm = 0.0;
  double episode_length = 0.0;
  double action_saturation = 0.0;  ///< fraction of action components beyond 0.95
  std::int64_t episodes = 0;

  /// Under the keys evaluation/...
  common::Scalars scalars() const;
  common::Json json() const;
};

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
