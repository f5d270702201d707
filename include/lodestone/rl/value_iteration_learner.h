#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/inference/cost_to_go.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/imagined_needle.h"
#include "lodestone/rl/imagined_task.h"
#include "lodestone/rl/learning_config.h"
#include "lodestone/rl/policy_learner.h"
#include "lodestone/rl/value_iteration_config.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/task.h"

namespace lodestone::rl {

/// Learns what it costs to bring a needle to a pose (inference::CostToGo), from trials in the learned
/// simulator, by fitted value iteration (Bertsekas and Tsitsiklis, Neuro-dynamic programming, 1996; Ernst et
/// al., 2005): at every decision pulses of many strengths and directions are tried on several outcomes, the
/// best is chosen, and what it is expected to cost on outcomes that it was not chosen by (but for whether to
/// rest instead) is what the network learns for the pose before. Resting at a goal that stays is judged by
/// what leaving the needle for good costs, exactly (PoseCost::of_staying). Some of the needles follow those
/// decisions, so that the poses learned from are those that a planner which decides so comes to. And a policy
/// learns the decisions themselves (imitate()): what the planner searches for, in one forward pass. Its
/// proposals are tried beside the others, so that search and policy better one another (expert iteration:
/// Anthony, Tian and Barber, 2017); and the other needles follow the policy, so that it is told what to do
/// where it comes to itself (Ross, Gordon and Bagnell, DAgger, 2011). Well within the tolerances it is told
/// to rest: what the search can still better there, it would sooner spoil.
///
/// Rigs, their gain, and places that hold the needle are imagined as by ModelGradientLearner. Work is cut
/// into shards of fixed size with random streams of their own, so the result does not depend on the number
/// of threads.
class ValueIterationLearner final : public PolicyLearner {
 public:
  /// `threads`: 0 means one per processor. Throws ConfigError when the dynamics predict single values or
  /// have no heading, or when the goal has none.
  ValueIterationLearner(const LearningConfig& learning, const ValueIterationConfig& config,
                        const ImaginedTask& task, inference::DynamicsModel model, std::uint64_t seed,
                        std::int64_t threads);

  void step() override;
  std::int64_t env_steps() const override { return env_steps_; }
  std::int64_t updates() const override { return updates_; }
  bool finished() const override { return env_steps_ >= learning_.env_steps; }
  inference::Actor actor() const override;
  inference::Arrays actor_weights() const override;
  std::optional<inference::CostToGo> cost_to_go() const override;
  /// train/critic_loss (mean squared error of the cost-to-go, as a share of the most that it can be),
  /// train/actor_loss (imitate()), action_saturation.
  common::Scalars take_statistics() override;
  void save(nets::Checkpoint& checkpoint) override;
  void load(const nets::Checkpoint& checkpoint) override;

 private:
  struct Needle : ImaginedNeedle {
    geometry::Pose2 goal;
    geometry::Vector2 goal_step_m = geometry::Vector2::Zero();  // by which it moves during a pulse,
    double goal_turn_rad = 0.0;                                 // and turns
    bool still() const { return goal_step_m.isZero(0.0); }
  };
  /// What one needle was decided for at one moment, to be learned from.
  struct Decision {
    std::vector<float> observation;
    float features[inference::CostToGo::kFeatures] = {};
    double cost = 0.0;       ///< expected, as a share of the most
    bool still = false;      ///< the goal stays where it is
    geometry::Drive action;  ///< for the policy
  };
  struct Tries;
  /// Needles that are worked on together, with buffers.
  struct Shard {
    Shard(std::uint64_t seed, std::size_t index, std::int64_t rows);
    common::RandomStream random;
    std::vector<Needle> needles;
    std::vector<Decision> decisions;  // a ring, [replayed, needles], as far as it is filled
    FlatNetwork<float>::Workspace actor, value;
    inference::FoldedDynamics::Workspace dynamics;
    inference::CostToGo::Workspace judge;
    std::vector<geometry::Pose2> seen, goal_after;  // [needles]
    std::vector<geometry::Drive> given;             // likewise
    std::vector<double> state, drive, next, cost;   // of what is tried
    std::vector<float> observation, features, actor_gradient, value_gradient;
    double value_loss = 0.0, actor_loss = 0.0, saturated = 0.0;
  };

  void renew_judge();
  void draw_pose(Needle& needle, common::RandomStream& random) const;
  void draw_goal(Needle& needle, common::RandomStream& random) const;
  geometry::Pose2 goal_after(const Needle& needle) const;
  void observe(Shard& shard) const;
  /// What every try of every needle is expected to cost, over so many outcomes that are the same for all.
  void judge(Shard& shard, Tries& tries, std::int64_t particles, std::size_t turn) const;
  /// Chooses a pulse for every needle, notes what it is expected to cost, and lets the pulses happen.
  void decide(Shard& shard, std::size_t turn) const;
  void give_pulses(Shard& shard, std::size_t turn) const;
  /// Writes the shard's gradients, of decisions drawn from its ring.
  void learn(Shard& shard) const;
  /// One step of Adam along the sum of the shards' gradients.
  template <class GradientOf>
  void descend(FlatNetwork<float>& network, at::Tensor (&moments)[2], double rate,
               const GradientOf& gradient_of) const;
  double progress() const;

  LearningConfig learning_;
  ValueIterationConfig config_;
  ImaginedTask task_;
  task::ObservationEncoder encoder_;
  inference::DynamicsModel model_;
  std::vector<geometry::Pose2> starts_;
  FlatNetwork<float> actor_, value_, target_;
  std::optional<inference::CostToGo> judge_;  // target_, for evaluation
  at::Tensor actor_moments_[2], value_moments_[2];
  std::vector<Shard> shards_;
  common::ThreadPool pool_;
  std::int64_t env_steps_ = 0;
  std::int64_t decisions_ = 0;
  std::int64_t updates_ = 0;
  double value_loss_sum_ = 0.0, actor_loss_sum_ = 0.0, saturated_sum_ = 0.0, updates_summed_ = 0.0;
};

}  // namespace lodestone::rl
