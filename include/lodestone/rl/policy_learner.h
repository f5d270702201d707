#pragma once

#include <cstdint>
#include <optional>

#include "lodestone/common/metrics.h"
#include "lodestone/inference/actor_critic.h"
#include "lodestone/inference/cost_to_go.h"
#include "lodestone/nets/checkpoint.h"

namespace lodestone::rl {

/// Learns a policy step by step. Everything that later steps depend on can be saved: N steps, save, load and
/// N steps equal 2 N steps, bitwise.
class PolicyLearner {
 public:
  virtual ~PolicyLearner() = default;

  virtual void step() = 0;
  /// Pulses simulated so far, all environments together.
  virtual std::int64_t env_steps() const = 0;
  virtual std::int64_t updates() const = 0;
  virtual bool finished() const = 0;
  /// The policy as it is now: for acting, and its weights "l1.weight", ...
  virtual inference::Actor actor() const = 0;
  virtual inference::Arrays actor_weights() const = 0;
  /// What it learned that planners go by; nothing from most.
  virtual std::optional<inference::CostToGo> cost_to_go() const { return std::nullopt; }
  /// Means since the last call, under the keys train/...; keys without data are left out.
  virtual common::Scalars take_statistics() = 0;

  virtual void save(nets::Checkpoint& checkpoint) = 0;
  /// Throws CheckpointError when it comes from another configuration.
  virtual void load(const nets::Checkpoint& checkpoint) = 0;
};

}  // namespace lodestone::rl
