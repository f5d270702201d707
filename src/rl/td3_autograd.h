#pragma once

#include <cstdint>
#include <memory>

#include <torch/optim/adam.h>

#include "lodestone/nets/actor_critic.h"
#include "lodestone/rl/td3.h"

namespace lodestone::rl {

/// TD3 in plain LibTorch: modules, autograd and torch::optim::Adam. Slower than FusedTd3 and written to be
/// read; the two start from the same networks and are compared by a test.
class AutogradTd3 final : public Td3 {
 public:
  AutogradTd3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
              std::uint64_t seed, torch::ScalarType type);

  nets::NamedTensors networks() const override;

 protected:
  torch::Tensor policy(const torch::Tensor& observation) override;
  UpdateResult learn(const Batch& batch, const torch::Tensor& smoothing_noise, bool policy_too) override;
  nets::NamedTensors optimiser() const override;
  void counters_loaded() override;

 private:
  nets::Actor actor_, actor_target_;
  nets::TwinCritic critic_, critic_target_;
  std::unique_ptr<torch::optim::Adam> actor_optimiser_, critic_optimiser_;
};

}  // namespace lodestone::rl
