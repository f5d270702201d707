#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/inference/array.h"

namespace lodestone::env {

struct EnvSpec {
  std::int64_t count = 0;             ///< N environments
  std::int64_t observation_size = 0;  ///< D
  std::int64_t action_size = 2;       ///< A, each in [-1, 1]
};

/// One step of all environments, row after row.
struct StepResult {
  std::vector<float> observation;        ///< [N, D]; already that of the next episode where one ended
  std::vector<float> reward;             ///< [N]
  std::vector<std::uint8_t> terminated;  ///< [N] 1: the episode ended by the task's rules (no bootstrap)
  std::vector<std::uint8_t> truncated;   ///< [N] 1: cut by the step limit (bootstrap from final_observation)
  std::vector<std::uint8_t> success;     ///< [N] 1: within the success radius
  std::vector<float> final_observation;  ///< [N, D]: the true next observation of every environment
  std::vector<float> action;    ///< [N, A]: what was done, where that is not what was asked; else empty
  std::vector<double> penalty;  ///< [N] what the reward is short of the task's own
  std::vector<double>
      progress;  ///< [N] of the training, which the task's rules went by: task::Step::progress
};

/// State of an environment for bitwise resumption.
struct Snapshot {
  common::Json facts;  ///< RNG states, counters
  inference::Arrays arrays;
};

/// N environments stepped as one batch, with automatic reset in the same step.
class VecEnv {
 public:
  virtual ~VecEnv() = default;
  virtual EnvSpec spec() const = 0;
  /// Starts new episodes everywhere; returns [N, D] observations, valid until the next call.
  virtual const std::vector<float>& reset() = 0;
  /// `actions` [N, A]; throws LogicFault on another number of them. The result belongs to the environments
  /// and is valid until the next call.
  virtual const StepResult& step(const std::vector<float>& actions) = 0;
  virtual Snapshot save() const = 0;
  /// Afterwards, steps go on bitwise as they would have after save(). Throws CheckpointError.
  virtual void load(const Snapshot& snapshot) = 0;
};

}  // namespace lodestone::env
