#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/rl/expected_distance.h"
#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/imagined_needle.h"
#include "lodestone/rl/imagined_task.h"
#include "lodestone/rl/learning_config.h"
#include "lodestone/rl/model_gradient_config.h"
#include "lodestone/rl/policy_learner.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/region.h"
#include "lodestone/task/task.h"

namespace lodestone::rl {

/// Learns a policy whose next pulse brings the needle as near to its target as the learned simulator expects
/// any pulse to: Adam on the expected distance, differentiated through the simulator's predicted distribution
/// into the policy's weights. What a one-pulse planner searches for at every decision, this learns once, for
/// all poses, targets and gains of the drive (compare Deisenroth and Rasmussen, PILCO, 2011; Heess et al.,
/// Stochastic value gradients, 2015).
///
/// The best pulse jumps where another way to the target becomes the better one, and a smooth function would
/// give the mean of the two. So the policy proposes several, and scores them and resting: the scores learn
/// which of them is expected to be best (cross-entropy), and of the proposals mostly the best one learns.
/// Costs are weighed by their ratio, or pulses far from their target would drown those that end at it.
///
/// One step: every needle has a pose, a target that may move, a gain of the drive and an estimate of it that
/// the policy is told, and friction that stays with the place: a pulse like the one that moved nothing moves
/// nothing again. All of them together give one step of Adam; then each gives its pulse, so that the poses
/// learned from are those the policy comes to. Work is cut into shards of fixed size with random streams of
/// their own, so the result does not depend on the number of threads.
class ModelGradientLearner final : public PolicyLearner {
 public:
  /// `threads`: 0 means one per processor. Throws ConfigError when the dynamics predict single values, or
  /// when the goal has a heading, which is not imagined here.
  ModelGradientLearner(const LearningConfig& learning, const ModelGradientConfig& config,
                       const ImaginedTask& task, inference::DynamicsModel model, std::uint64_t seed,
                       std::int64_t threads);

  void step() override;
  std::int64_t env_steps() const override { return env_steps_; }
  std::int64_t updates() const override { return updates_; }
  bool finished() const override { return env_steps_ >= learning_.env_steps; }
  inference::Actor actor() const override;
  inference::Arrays actor_weights() const override;
  /// train/actor_loss (mean expected distance after a pulse in mm, and what the pulse costs),
  /// action_saturation.
  common::Scalars take_statistics() override;
  void save(nets::Checkpoint& checkpoint) override;
  void load(const nets::Checkpoint& checkpoint) override;

 private:
  struct Needle : ImaginedNeedle {
    geometry::Vector2 target_m = geometry::Vector2::Zero();
    geometry::Vector2 target_step_m = geometry::Vector2::Zero();  // by which it moves during a pulse
    geometry::Vector2 stalled = geometry::Vector2::Zero();  // the action that moved nothing here; zero: none
  };
  /// Needles that are worked on together, with buffers.
  struct Shard {
    Shard(std::uint64_t seed, std::size_t index, std::int64_t rows);
    common::RandomStream random;
    std::vector<Needle> needles;
    FlatNetwork<float>::Workspace actor;
    ExpectedDistance::Workspace distance;
    std::vector<float> observation, output_gradient;
    std::vector<double> state, drive, target_m, cost_mm, gradient;
    std::vector<geometry::Vector2> tried;
    std::vector<double> each_mm;       // [rows, proposals + 1], resting last
    std::vector<std::int64_t> chosen;  // [rows]
    double loss_mm = 0.0;
    double saturated = 0.0;
  };

  void draw_pose(Needle& needle, common::RandomStream& random) const;
  void draw_goal(Needle& needle, common::RandomStream& random) const;
  /// Writes the shard's gradient, then lets its pulses happen.
  void work_on(Shard& shard, const ExpectedDistance& simulator) const;
  void observe(Shard& shard) const;
  /// Drives of `action`, and what they are expected to cost; with gradients if wanted.
  void evaluate(Shard& shard, const ExpectedDistance& simulator, const std::vector<geometry::Vector2>& action,
                double turn_rad, bool gradient) const;
  void give_pulses(Shard& shard, const ExpectedDistance& simulator) const;
  double progress() const;

  LearningConfig learning_;
  ModelGradientConfig config_;
  ImaginedTask task_;
  task::ObservationEncoder encoder_;
  inference::DynamicsModel model_;
  std::vector<geometry::Pose2> starts_;
  std::vector<ExpectedDistance> simulators_;  // one of each member
  FlatNetwork<float> actor_;
  at::Tensor first_moment_, second_moment_, gradient_;
  std::vector<Shard> shards_;
  common::ThreadPool pool_;
  std::int64_t env_steps_ = 0;
  std::int64_t updates_ = 0;
  double loss_mm_sum_ = 0.0, saturated_sum_ = 0.0, steps_summed_ = 0.0;
};

}  // namespace lodestone::rl
