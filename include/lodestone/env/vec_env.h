#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <torch/torch.h>

#include "lodestone/common/config.h"

namespace lodestone::env {

struct EnvSpec {
  std::int64_t count = 0;             ///< N environments
  std::int64_t observation_size = 0;  ///< D
  std::int64_t action_size = 2;       ///< A, each in [-1, 1]
};

/// One step of all environments. The tensors belong to the environment and are valid until the next call.
struct StepResult {
  torch::Tensor observation;  ///< [N, D] float32; already that of the next episode where one ended
  torch::Tensor reward;       ///< [N] float32
  torch::Tensor terminated;   ///< [N] uint8: the episode ended by the task's rules (no bootstrap)
  torch::Tensor truncated;    ///< [N] uint8: it was cut by the step limit (bootstrap from final_observation)
  torch::Tensor success;      ///< [N] uint8: within the success radius
  torch::Tensor final_observation;  ///< [N, D] float32: the true next observation of every environment
  torch::Tensor action;  ///< [N, A] float32: what was done, where that is not what was asked; else undefined
};

/// State of an environment for bitwise resumption.
struct EnvState {
  common::Json facts;  ///< RNG states, counters
  std::map<std::string, torch::Tensor> tensors;
};

/// N environments stepped as one batch, with automatic reset in the same step.
class VecEnv {
 public:
  virtual ~VecEnv() = default;
  virtual EnvSpec spec() const = 0;
  /// Starts new episodes everywhere; returns [N, D] observations.
  virtual torch::Tensor reset() = 0;
  /// actions: [N, A] float32; throws LogicFault on another shape or type.
  virtual StepResult step(const torch::Tensor& actions) = 0;
  /// Saves into `state`, or with `load` takes it up; after loading, steps go on bitwise as they would have.
  virtual void exchange_state(EnvState& state, bool load) = 0;
};

}  // namespace lodestone::env
