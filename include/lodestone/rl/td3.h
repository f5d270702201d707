#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/replay_buffer.h"

namespace lodestone::rl {

/// Hyperparameters of TD3; defaults are those of Fujimoto et al. (2018), learning rate as the paper (IV-B2).
struct Td3Config {
  std::string backend = "fused";
  double discount = 0.99;
  double polyak_tau = 0.005;
  double learning_rate = 3e-4;
  double policy_noise = 0.2;
  double noise_clip = 0.5;
  std::int64_t policy_frequency = 2;
  std::int64_t batch_size = 256;
  std::vector<std::int64_t> hidden = {256, 256};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("backend", backend, "",
            "who computes an update: written-out passes on up to two threads, or plain LibTorch with "
            "autograd, the "
            "readable reference; both agree to rounding",
            {"fused", "autograd"});
    v.field("discount", discount, "", "discount per step", {0.0, 1.0});
    v.field("polyak_tau", polyak_tau, "",
            "fraction of the network that moves into its target per policy update", {0.0, 1.0});
    v.field("learning_rate", learning_rate, "", "Adam's step size, actor and critics", {0.0, 1.0});
    v.field("policy_noise", policy_noise, "action units",
            "standard deviation of the target policy's smoothing noise", {0.0, 2.0});
    v.field("noise_clip", noise_clip, "action units", "bound of the smoothing noise", {0.0, 2.0});
    v.field("policy_frequency", policy_frequency, "updates", "critic updates per policy and target update",
            {1, 1000});
    v.field("batch_size", batch_size, "transitions", "transitions per update", {2, 1 << 20});
    v.field("hidden", hidden, "", "width of each hidden layer, actor and critics", {1, 8192});
  }
};

/// What one update saw, before it moved anything.
struct UpdateResult {
  double critic_loss = 0.0;  ///< mean squared error of both critics, summed
  double q_mean = 0.0;       ///< of the first critic on the batch
  bool policy_updated = false;
  double actor_loss = 0.0;  ///< -mean Q1(s, pi(s)); only when the policy was updated
  torch::Tensor target_q;   ///< [B]; valid until the next update
};

/// Twin delayed deep deterministic policy gradient (Fujimoto, van Hoof and Meger, ICML 2018), on the CPU:
/// what its backends have in common. make_td3() chooses one.
class Td3 {
 public:
  virtual ~Td3() = default;
  Td3(const Td3&) = delete;
  Td3& operator=(const Td3&) = delete;

  /// Deterministic policy: [N, D] -> [N, A] in [-1, 1]; a new tensor.
  torch::Tensor act(const torch::Tensor& observation);

  /// One update on a batch drawn from the buffer, with smoothing noise from this object's stream. float32
  /// only.
  UpdateResult update(const ReplayBuffer& buffer);
  /// One update on a given batch of config.batch_size rows; `smoothing_noise` [B, A] in action units, before
  /// clipping.
  UpdateResult update(const Batch& batch, const torch::Tensor& smoothing_noise);

  void set_learning_rate(double learning_rate) { learning_rate_ = learning_rate; }
  std::int64_t updates() const { return updates_; }

  /// Views (not copies) by name: "actor.l1.weight", "critic.l1.." to "critic.l6..", "actor_target..",
  /// "critic_target..", in the reference implementation's names.
  virtual nets::NamedTensors networks() const = 0;
  /// The actor alone, "l1.weight", ...: what nets::Actor takes.
  nets::NamedTensors actor() const;

  /// Everything that the next update depends on, and back; either backend takes up what the other saved. load
  /// throws CheckpointError.
  void save(nets::Checkpoint& checkpoint) const;
  void load(const nets::Checkpoint& checkpoint);

 protected:
  Td3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size, std::uint64_t seed,
      torch::ScalarType type);

  virtual torch::Tensor policy(const torch::Tensor& observation) = 0;
  /// One update of the critics, with `policy_too` of the policy and the targets as well. The batch is
  /// checked; updates() counts it already.
  virtual UpdateResult learn(const Batch& batch, const torch::Tensor& smoothing_noise, bool policy_too) = 0;
  /// Views of Adam's moments: "actor.first_moment.l1.weight", ..., "critic.second_moment.l6.bias".
  virtual nets::NamedTensors optimiser() const = 0;
  /// After load(): updates() has changed.
  virtual void counters_loaded() {}

  const Td3Config& config() const { return config_; }
  double learning_rate() const { return learning_rate_; }
  /// Adam's steps so far: of the critics, one per update.
  std::int64_t critic_steps() const { return updates_; }
  std::int64_t actor_steps() const { return updates_ / config_.policy_frequency; }

 private:
  void check_batch(const Batch& batch, const torch::Tensor& noise) const;

  Td3Config config_;
  std::int64_t observation_size_;
  std::int64_t action_size_;
  torch::ScalarType type_;
  double learning_rate_;
  std::int64_t updates_ = 0;
  common::RandomStream random_;
  Batch batch_;
  torch::Tensor noise_;
};

/// Networks are drawn from `seed`, the same ones for both backends. float32 for training, float64 for checks.
/// The fused backend uses up to two threads, with the same result at any number of them.
std::unique_ptr<Td3> make_td3(const Td3Config& config, std::int64_t observation_size,
                              std::int64_t action_size, std::uint64_t seed, std::int64_t threads = 1,
                              torch::ScalarType type = torch::kFloat32);

}  // namespace lodestone::rl
