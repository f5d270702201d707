#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/inference/actor_critic.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/replay_buffer.h"
#include "lodestone/rl/td3_config.h"

namespace lodestone::rl {

/// What one update saw, before it moved anything.
struct UpdateResult {
  double critic_loss = 0.0;  ///< mean squared error of both critics, summed
  double q_mean = 0.0;       ///< of the first critic on the batch
  bool policy_updated = false;
  double actor_loss = 0.0;  ///< -mean Q1(s, pi(s)); only when the policy was updated
  at::Tensor target_q;      ///< [B]; valid until the next update
};

/// Twin delayed deep deterministic policy gradient (Fujimoto, van Hoof and Meger, ICML 2018), on the CPU:
/// what its backends have in common. make_td3() chooses one.
class Td3 {
 public:
  virtual ~Td3() = default;
  Td3(const Td3&) = delete;
  Td3& operator=(const Td3&) = delete;

  /// Deterministic policy: [N, D] -> [N, A] in [-1, 1]. Throws LogicFault on another size.
  std::vector<float> act(const std::vector<float>& observation);

  /// One update on a batch drawn from the buffer, with smoothing noise from this object's stream. float32
  /// only.
  UpdateResult update(const ReplayBuffer& buffer);
  /// One update on a given batch of config.batch_size rows; `smoothing_noise` [B, A] in action units, before
  /// clipping.
  UpdateResult update(const Batch& batch, const at::Tensor& smoothing_noise);

  void set_learning_rate(double learning_rate) { learning_rate_ = learning_rate; }
  std::int64_t updates() const { return updates_; }

  /// Views (not copies) by name: "actor.l1.weight", "critic.l1.." to "critic.l6..", "actor_target..",
  /// "critic_target..", in the reference implementation's names.
  virtual nets::NamedTensors networks() const = 0;
  /// The actor alone, "l1.weight", ...
  nets::NamedTensors actor_weights() const;
  /// The policy as it is now, for acting.
  inference::Actor actor() const;

  /// Everything that the next update depends on, and back; either backend takes up what the other saved. load
  /// throws CheckpointError.
  void save(nets::Checkpoint& checkpoint) const;
  void load(const nets::Checkpoint& checkpoint);

 protected:
  Td3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size, std::uint64_t seed,
      at::ScalarType type);

  virtual at::Tensor policy(const at::Tensor& observation) = 0;
  /// One update of the critics, with `policy_too` of the policy and the targets as well. The batch is
  /// checked; updates() counts it already.
  virtual UpdateResult learn(const Batch& batch, const at::Tensor& smoothing_noise, bool policy_too) = 0;
  /// Views of Adam's moments: "actor.first_moment.l1.weight", ..., "critic.second_moment.l6.bias".
  virtual nets::NamedTensors optimiser() const = 0;

  const Td3Config& config() const { return config_; }
  double learning_rate() const { return learning_rate_; }
  /// Adam's steps so far: of the critics, one per update.
  std::int64_t critic_steps() const { return updates_; }
  std::int64_t actor_steps() const { return updates_ / config_.policy_frequency; }

 private:
  void check_batch(const Batch& batch, const at::Tensor& noise) const;

  Td3Config config_;
  std::int64_t observation_size_;
  std::int64_t action_size_;
  at::ScalarType type_;
  double learning_rate_;
  std::int64_t updates_ = 0;
  common::RandomStream random_;
  Batch batch_;
  at::Tensor noise_;
};

/// What products are computed in here: what was asked for, or float32 where that is the faster one.
Td3Products products_here(Td3Products asked);

/// Networks are drawn from `seed`, the same ones for both backends. float32 for training, float64 for checks.
/// The fused backend uses up to two threads, with the same result at any number of them.
std::unique_ptr<Td3> make_td3(const Td3Config& config, std::int64_t observation_size,
                              std::int64_t action_size, std::uint64_t seed, std::int64_t threads = 1,
                              at::ScalarType type = at::kFloat);

}  // namespace lodestone::rl
