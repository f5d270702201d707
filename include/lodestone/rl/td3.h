#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/replay_buffer.h"

namespace lodestone::rl {

/// Hyperparameters of TD3; defaults are those of Fujimoto et al. (2018), learning rate as the paper (IV-B2).
struct Td3Config {
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
    v.field("discount", discount, "", "discount per step", {0.0, 1.0});
    v.field("polyak_tau", polyak_tau, "", "share of the network that moves into its target per policy update",
            {0.0, 1.0});
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

/// Twin delayed deep deterministic policy gradient (Fujimoto, van Hoof and Meger, ICML 2018), on the CPU.
///
/// Work is cut into two shards whatever the number of threads (the two critics, or two halves of the batch),
/// so that results do not depend on it.
class Td3 {
 public:
  /// Networks are drawn from `seed`. float32 for training, float64 for checks. `threads` beyond 2 are not
  /// used.
  Td3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size, std::uint64_t seed,
      std::int64_t threads = 1, torch::ScalarType type = torch::kFloat32);

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
  nets::NamedTensors networks() const;
  /// The actor alone, "l1.weight", ...: what nets::Actor takes.
  nets::NamedTensors actor() const;

  /// Everything that the next update depends on, and back. load throws CheckpointError.
  void save(nets::Checkpoint& checkpoint) const;
  void load(const nets::Checkpoint& checkpoint);

 private:
  struct Learner {  // a network, its target, and Adam's moments
    Learner(FlatNetwork drawn);
    FlatNetwork network, target;
    torch::Tensor first_moment, second_moment;
    std::int64_t steps = 0;
    void adam(const torch::Tensor& gradient, double learning_rate);
    void polyak(double tau);
  };
  struct Half {  // scratch of one half of the batch
    std::int64_t start, rows;
    FlatNetwork::Workspace actor, critic;
    torch::Tensor policy, critic_input, policy_gradient;
  };

  void check_batch(const Batch& batch, const torch::Tensor& noise) const;
  void smoothed_target_actions(const Batch& batch, const torch::Tensor& noise, Half& half);
  double update_policy(const Batch& batch);
  nets::NamedTensors optimiser() const;

  Td3Config config_;
  std::int64_t observation_size_;
  std::int64_t action_size_;
  double learning_rate_;
  std::int64_t updates_ = 0;
  common::RandomStream random_;
  common::ThreadPool threads_;
  Learner actor_;
  std::array<Learner, 2> critics_;
  // preallocated for one batch
  Batch batch_;
  torch::Tensor noise_, critic_input_, next_input_, target_q_;
  std::array<FlatNetwork::Workspace, 2> critic_work_, target_work_;
  std::array<torch::Tensor, 2> q_gradient_;
  std::vector<Half> halves_;
  FlatNetwork::Workspace act_work_;
};

}  // namespace lodestone::rl
