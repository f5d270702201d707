#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lodestone/common/metrics.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/hindsight.h"
#include "lodestone/rl/learning_config.h"
#include "lodestone/rl/ou_noise.h"
#include "lodestone/rl/policy_learner.h"
#include "lodestone/rl/replay_buffer.h"
#include "lodestone/rl/td3.h"

namespace lodestone::rl {

/// Collects from a batch of environments and learns from it with TD3.
///
/// With `overlap` the updates that fall due in one step are made during the next, from the transitions before
/// it: the lag is always one step, so results do not depend on timing or threads.
class Td3Learner final : public PolicyLearner {
 public:
  /// Takes the environments over: resets them. `environments` must outlive this. `threads` are those
  /// of the updates. With learning.hindsight, `hindsight` must be given.
  Td3Learner(const LearningConfig& learning, const Td3Config& td3, const NoiseConfig& noise,
             std::uint64_t seed, std::int64_t threads, env::VecEnv& environments,
             std::optional<Hindsight> hindsight = {});

  /// One step of every environment and the updates that fall due.
  void step() override;

  std::int64_t env_steps() const override { return env_steps_; }
  std::int64_t updates() const override { return td3_->updates(); }
  bool finished() const override { return env_steps_ >= learning_.env_steps; }
  inference::Actor actor() const override { return td3_->actor(); }
  inference::Arrays actor_weights() const override { return nets::to_arrays(td3_->actor_weights()); }
  Td3& td3() { return *td3_; }

  /// train/episode_return, success_rate, episode_length, critic_loss, actor_loss, q_mean, action_saturation
  /// (fraction of components beyond 0.95).
  common::Scalars take_statistics() override;

  void save(nets::Checkpoint& checkpoint) override;
  void load(const nets::Checkpoint& checkpoint) override;

 private:
  struct Mean {
    double sum = 0.0;
    double count = 0.0;
    void add(double value) {
      sum += value;
      count += 1.0;
    }
  };
  void make_due_updates();
  void check_finite(const env::StepResult& result) const;
  void check_finite(const UpdateResult& update) const;
  void count_episodes(const env::StepResult& result);
  std::vector<float> choose_actions();

  LearningConfig learning_;
  double learning_rate_;
  env::VecEnv& environments_;
  std::unique_ptr<Td3> td3_;
  ReplayBuffer buffer_;
  ExplorationNoise noise_;
  std::optional<Hindsight> hindsight_;
  common::ThreadPool overlap_;  // one thread unless environments and updates overlap
  std::int64_t env_steps_ = 0;
  double due_updates_ = 0.0;
  std::vector<float> observation_;  // [N, D]
  std::vector<float> returns_;      // [N] of the running episodes
  std::vector<float> lengths_;      // [N]
  Mean return_, success_, length_, critic_loss_, actor_loss_, q_, saturation_;
};

}  // namespace lodestone::rl
