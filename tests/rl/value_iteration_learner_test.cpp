#include "lodestone/rl/value_iteration_learner.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "env/linear_model.h"
#include "lodestone/common/error.h"

using lodestone::geometry::Pose2;
using lodestone::geometry::Vector2;
using lodestone::inference::CostToGo;
using lodestone::nets::Checkpoint;
using lodestone::rl::ImaginedTask;
using lodestone::rl::LearningConfig;
using lodestone::rl::ValueIterationConfig;
using lodestone::rl::ValueIterationLearner;
namespace env_tests = lodestone::env::tests;

namespace {

constexpr double kStepGain_m = 1e-3;  // per unit of drive, of which an action of 1 has ten

LearningConfig iterating_for(std::int64_t env_steps) {
  LearningConfig learning;
  learning.env_steps = env_steps;
  learning.final_learning_rate = 0.1;
  return learning;
}

ValueIterationConfig small_iteration() {
  ValueIterationConfig config;
  config.value_hidden = {48, 48};
  config.hidden = {48, 48};
  config.proposals = 2;
  config.learning_rate = 3e-3;
  config.polyak = 0.2;
  config.candidates = 24;
  config.refinements = 12;
  config.particles = 2;
  config.updates = 12;
  config.replayed = 8;
  config.cost.discount = 0.8;
  config.place_sigma = 0.0;
  config.gain_sigma = 0.1;
  return config;
}

ImaginedTask pose_task_for(std::int64_t environments) {
  ImaginedTask task;
  task.task.goal = lodestone::task::GoalKind::kPose;
  task.task.goal_radius = 0.8;
  task.task.dish_radius_m = 0.0425;
  task.encoder.heading = lodestone::task::HeadingEncoding::kSineCosine;
  task.encoder.relative_target = true;
  task.encoder.target_heading = true;
  task.encoder.fine_distance_m = 0.0005;
  task.encoder.drive_gain = true;
  task.encoder.target_ahead = true;
  task.encoder.length_scale_m = 0.0425;
  task.action.scale = 10.0;
  task.environments = environments;
  return task;
}

std::unique_ptr<ValueIterationLearner> learner_for(std::int64_t env_steps, std::int64_t threads = 1,
                                                   int action_size = 2,
                                                   const ValueIterationConfig& config = small_iteration()) {
  ImaginedTask task = pose_task_for(128);
  task.encoder.memory = action_size > 2;
  task.encoder.action_size = task.action.size = action_size;
  return std::make_unique<ValueIterationLearner>(iterating_for(env_steps), config, task,
                                                 env_tests::noisy_linear_model(kStepGain_m, action_size), 1,
                                                 threads);
}

double learned_cost_of(const CostToGo& learned, const Pose2& pose, const Pose2& goal) {
  CostToGo::Workspace workspace;
  const double state[] = {pose.x_m, pose.y_m, pose.heading_rad};
  double cost = 0.0;
  learned.evaluate(state, &goal, 1, 1, &cost, workspace);
  return cost;
}

bool same_weights(const lodestone::inference::Arrays& one, const lodestone::inference::Arrays& two) {
  if (one.size() != two.size()) return false;
  for (const auto& [name, array] : one)
    if (array.to_vector<float>() != two.at(name).to_vector<float>()) return false;
  return true;
}

}  // namespace

TEST_CASE("A cost-to-go learns how many pulses away a pose is, and that some are out of reach", "[rl]") {
  // Where pulses move the needle by up to 10 mm along each axis, and never turn it.
  const auto learner = learner_for(120000);
  while (!learner->finished()) learner->step();
  const CostToGo learned = *learner->cost_to_go();
  const double most = learned.cost().most();
  const Pose2 goal{0.005, -0.004, 0.7};
  CHECK(learned_cost_of(learned, goal, goal) < 0.15 * most);
  const double near = learned_cost_of(learned, {0.008, -0.004, 0.7}, goal);
  const double far = learned_cost_of(learned, {-0.028, 0.012, 0.7}, goal);
  CHECK(near < 0.4 * most);                                                    // one pulse away
  CHECK(far > near);                                                           // four
  CHECK(learned_cost_of(learned, {0.008, -0.004, -2.0}, goal) > 0.75 * most);  // turned away, for good

  // And the policy gives the pulse that brings it there, from four millimetres away on all sides: on average
  // at least a fifth of the way, hardly beyond, and not to the side.
  const ImaginedTask task = pose_task_for(128);
  const lodestone::task::ObservationEncoder encoder(task.encoder);
  const lodestone::inference::Actor actor = learner->actor();
  std::vector<float> input(static_cast<std::size_t>(encoder.size()));
  lodestone::inference::Actor::Workspace workspace;
  double along = 0.0, across = 0.0;
  constexpr int kSides = 24;
  for (int side = 0; side < kSides; ++side) {
    const double angle_rad = 2.0 * 3.141592653589793 * side / kSides;
    const Vector2 away(std::cos(angle_rad), std::sin(angle_rad));
    lodestone::task::Observation seen;
    seen.pose = {goal.x_m + 0.004 * away.x(), goal.y_m + 0.004 * away.y(), 0.7};
    seen.target_m = goal.position_m();
    seen.target_heading_rad = goal.heading_rad;
    seen.drive_gain = lodestone::task::DriveGain{0.0, 0.05};
    encoder.encode(seen, input.data());
    float action[2];
    actor.act(input.data(), 1, action, workspace);
    const Vector2 pulse(action[0], action[1]);
    along += -pulse.dot(away) / 0.4 / kSides;  // 0.4 would bring it there at once
    across += std::abs(pulse.x() * away.y() - pulse.y() * away.x()) / 0.4 / kSides;
  }
  INFO("along " << along << ", across " << across);
  CHECK(along > 0.2);
  CHECK(along < 1.3);
  CHECK(across < 0.5 * along);
}

TEST_CASE("A policy rests well within the tolerances, where the search would still better the pose", "[rl]") {
  const auto rests = [](double rest_within, double off_m) {
    ValueIterationConfig config = small_iteration();
    config.cost.tolerance_m = 0.004;
    config.cost.tolerance_deg = 180.0;  // which pulses do not turn it by
    config.rest_within = rest_within;
    const auto learner = learner_for(60000, 1, 2, config);
    while (!learner->finished()) learner->step();
    const ImaginedTask task = pose_task_for(128);
    const lodestone::task::ObservationEncoder encoder(task.encoder);
    const lodestone::inference::Actor actor = learner->actor();
    std::vector<float> input(static_cast<std::size_t>(encoder.size()));
    lodestone::inference::Actor::Workspace workspace;
    int rested = 0;
    for (int side = 0; side < 24; ++side) {
      const double angle_rad = lodestone::geometry::kPi / 12.0 * side;
      lodestone::task::Observation seen;
      seen.target_m = {0.005, -0.004};
      seen.pose = {seen.target_m.x() + off_m * std::cos(angle_rad),
                   seen.target_m.y() + off_m * std::sin(angle_rad), 0.7};
      seen.target_heading_rad = 0.7;
      seen.drive_gain = lodestone::task::DriveGain{0.0, 0.05};
      encoder.encode(seen, input.data());
      rested += actor.ranked(input.data(), workspace).front().isZero(0.0) ? 1 : 0;
    }
    return rested;
  };
  const int told = rests(0.9, 0.0015);
  const int not_told = rests(0.0, 0.0015);
  INFO(told << " of 24, and where it is not told to " << not_told);
  CHECK(told > 8);  // as sharply as so small a network can
  CHECK(not_told < 3);
}

TEST_CASE("A cost-to-go is learned for actions of any number of numbers", "[rl]") {
  const auto learner = learner_for(40000, 1, 4);  // of which the last two move the needle
  while (!learner->finished()) learner->step();
  const CostToGo learned = *learner->cost_to_go();
  const double most = learned.cost().most();
  const Pose2 goal{0.005, -0.004, 0.7};
  const double near = learned_cost_of(learned, {0.008, -0.004, 0.7}, goal);
  CHECK(near < 0.4 * most);
  CHECK(learned_cost_of(learned, {-0.028, 0.012, 0.7}, goal) > near);
  CHECK(learned_cost_of(learned, {0.008, -0.004, -2.0}, goal) > 0.75 * most);
  CHECK(learner->actor().action_size() == 4);
}

TEST_CASE("Value iteration does not depend on threads, and goes on bitwise", "[rl]") {
  const int action_size = GENERATE(2, 3);
  const auto through = learner_for(100000, 2, action_size);
  const auto first = learner_for(100000, 1, action_size);
  for (int i = 0; i < 6; ++i) {
    through->step();
    first->step();
  }
  Checkpoint checkpoint;
  first->save(checkpoint);
  const auto second = learner_for(100000, 2, action_size);
  second->load(checkpoint);
  for (int i = 0; i < 6; ++i) {
    through->step();
    second->step();
  }
  CHECK(second->env_steps() == through->env_steps());
  CHECK(same_weights(through->actor_weights(), second->actor_weights()));
  CHECK(same_weights(through->cost_to_go()->weights(), second->cost_to_go()->weights()));
  Checkpoint broken = checkpoint;
  broken.parts["running"].erase("decisions");
  CHECK_THROWS_WITH(learner_for(1000, 1, action_size)->load(broken),
                    Catch::Contains("\"decisions\" is missing"));
}

TEST_CASE("Needles follow the search, or as many as told the policy", "[rl]") {
  const auto weights = [](double policy_share) {
    ValueIterationConfig config = small_iteration();
    config.policy_share = policy_share;
    const auto learner = learner_for(100000, 1, 2, config);
    for (int i = 0; i < 2; ++i) learner->step();
    return learner->actor_weights();
  };
  const auto search = weights(0.0), half = weights(0.5), policy = weights(1.0);
  CHECK(same_weights(search, weights(0.001)));  // of 64 needles none
  CHECK_FALSE(same_weights(search, half));
  CHECK_FALSE(same_weights(half, policy));
  CHECK_FALSE(same_weights(search, policy));
}

TEST_CASE("Value iteration refuses what has no heading or no distribution", "[rl]") {
  const auto start = [](const ImaginedTask& task, const lodestone::inference::DynamicsModel& model) {
    ValueIterationLearner(iterating_for(1000), small_iteration(), task, model, 1, 1);
  };
  CHECK_THROWS_WITH(start(pose_task_for(8),
                          env_tests::linear_model(lodestone::data::StateLayout::kPose, {kStepGain_m}, {0.0})),
                    Catch::Contains("model.components"));
  ImaginedTask point = pose_task_for(8);
  point.task.goal = lodestone::task::GoalKind::kPoint;
  CHECK_THROWS_WITH(start(point, env_tests::noisy_linear_model(kStepGain_m)), Catch::Contains("task.goal"));
}
