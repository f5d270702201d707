#include "lodestone/rl/model_gradient_learner.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include <ATen/ATen.h>

#include "env/linear_model.h"
#include "lodestone/common/error.h"

using lodestone::nets::Checkpoint;
using lodestone::rl::ImaginedTask;
using lodestone::rl::LearningConfig;
using lodestone::rl::ModelGradientConfig;
using lodestone::rl::ModelGradientLearner;
namespace env_tests = lodestone::env::tests;

namespace {

constexpr double kGain_m = 1e-3;  // per unit of drive, of which an action of 1 has ten

LearningConfig learning_for(std::int64_t env_steps) {
  LearningConfig learning;
  learning.env_steps = env_steps;
  learning.final_learning_rate = 0.02;
  return learning;
}

ModelGradientConfig small_config() {
  ModelGradientConfig config;
  config.hidden = {48, 48};
  config.learning_rate = 3e-3;
  config.proposals = 2;
  config.place_sigma = 0.0;
  config.current_cost_mm = 0.0;
  return config;
}

ImaginedTask task_for(std::int64_t environments) {
  ImaginedTask task;
  task.task.goal = lodestone::task::GoalKind::kPoint;
  task.task.goal_radius = 0.8;
  task.task.dish_radius_m = 0.0425;
  task.encoder.heading = lodestone::task::HeadingEncoding::kSineCosine;
  task.encoder.relative_target = true;
  task.encoder.fine_distance_m = 0.0002;
  task.encoder.drive_gain = true;
  task.encoder.target_ahead = true;
  task.encoder.length_scale_m = 0.0425;
  task.action.scale = 10.0;
  task.environments = environments;
  return task;
}

/// Every other pulse moves nothing; the others move by `gain_m` metres per unit of drive.
lodestone::inference::DynamicsModel sticking_model(double gain_m) {
  namespace inference = lodestone::inference;
  constexpr auto kLayout = lodestone::data::StateLayout::kPose;
  constexpr double kUnit_m = 1e-3;
  inference::DynamicsModel model = env_tests::empty_linear_model(kLayout, 1);
  model.config.components = 2;
  const std::int64_t outputs = model.config.mixture(kLayout).outputs();
  const std::int64_t second_mean = 2 + 3;
  inference::Arrays weights =
      env_tests::passing_drive_on(model.config.inputs(kLayout), 3, outputs, second_mean, gain_m / kUnit_m);
  std::vector<float> bias(static_cast<std::size_t>(outputs));
  std::fill(bias.begin() + 8, bias.end(), -20.0F);  // hardly any spread
  weights["layers.2.bias"] = {std::move(bias), {outputs}};
  weights["output_std"] = {std::vector<float>(3, static_cast<float>(kUnit_m)), {3}};
  model.members.emplace_back(weights, model.config, kLayout, "sticking model");
  return model;
}

bool same(const lodestone::inference::Arrays& one, const lodestone::inference::Arrays& two) {
  if (one.size() != two.size()) return false;
  for (const auto& [name, array] : one)
    if (array.to_vector<float>() != two.at(name).to_vector<float>()) return false;
  return true;
}

}  // namespace

TEST_CASE("Down the gradient a policy learns the pulse that ends at its target, on rigs of any gain",
          "[rl]") {
  const ImaginedTask task = task_for(128);
  ModelGradientLearner learner(learning_for(600000), small_config(), task,
                               env_tests::noisy_linear_model(kGain_m), 1, 1);
  const lodestone::task::ObservationEncoder encoder(task.encoder);
  const auto mean_error_mm = [&] {
    const lodestone::inference::Actor actor = learner.actor();
    lodestone::inference::Actor::Workspace workspace;
    lodestone::common::RandomStream random(5, "goals");
    double error_mm = 0.0;
    constexpr int kGoals = 200;
    for (int i = 0; i < kGoals; ++i) {
      const double log_gain = random.uniform(-0.4, 0.4);
      lodestone::task::Observation seen;
      seen.pose = {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(-3.0, 3.0)};
      seen.target_m = seen.pose.position_m() + lodestone::geometry::Vector2(random.uniform(-0.004, 0.004),
                                                                            random.uniform(-0.004, 0.004));
      seen.drive_gain = lodestone::task::DriveGain{log_gain, 0.05};
      std::vector<float> input(static_cast<std::size_t>(encoder.size()));
      encoder.encode(seen, input.data());
      float action[2];
      actor.act(input.data(), 1, action, workspace);
      const lodestone::geometry::Vector2 next_m =
          seen.pose.position_m() + kGain_m * task.action.scale * std::exp(log_gain) *
                                       lodestone::geometry::Vector2(action[0], action[1]);
      error_mm += 1e3 * (next_m - seen.target_m).norm() / kGoals;
    }
    return error_mm;
  };
  CHECK(mean_error_mm() > 2.0);
  while (!learner.finished()) learner.step();
  CHECK(mean_error_mm() < 0.5);
}

TEST_CASE("A needle that lies at its target is left alone", "[rl]") {
  const ImaginedTask task = task_for(128);
  ModelGradientLearner learner(learning_for(200000), small_config(), task,
                               env_tests::noisy_linear_model(kGain_m), 1, 1);
  while (!learner.finished()) learner.step();
  const lodestone::task::ObservationEncoder encoder(task.encoder);
  lodestone::task::Observation seen;
  seen.drive_gain = lodestone::task::DriveGain{0.0, 0.05};
  std::vector<float> input(static_cast<std::size_t>(encoder.size()));
  encoder.encode(seen, input.data());
  float action[2] = {1.0F, 1.0F};
  lodestone::inference::Actor::Workspace workspace;
  learner.actor().act(input.data(), 1, action, workspace);
  CHECK(action[0] == 0.0F);  // exactly, so that no coil is switched on
  CHECK(action[1] == 0.0F);
}

TEST_CASE("A pulse that moved nothing is not repeated", "[rl]") {
  ImaginedTask task = task_for(128);
  task.encoder.memory = true;
  ModelGradientConfig config = small_config();
  config.gain_sigma = config.least_gain_sigma = 0.0;
  config.proposals = 4;
  ModelGradientLearner learner(learning_for(600000), config, task, sticking_model(kGain_m), 1, 1);
  while (!learner.finished()) learner.step();
  const lodestone::inference::Actor actor = learner.actor();
  const lodestone::task::ObservationEncoder encoder(task.encoder);
  lodestone::inference::Actor::Workspace workspace;
  const auto decide = [&](const lodestone::task::Observation& seen) {
    std::vector<float> input(static_cast<std::size_t>(encoder.size()));
    encoder.encode(seen, input.data());
    float action[2];
    actor.act(input.data(), 1, action, workspace);
    return lodestone::geometry::Vector2(action[0], action[1]);
  };
  lodestone::common::RandomStream random(6, "goals");
  int right = 0;
  int other = 0;
  constexpr int kGoals = 60;
  for (int i = 0; i < kGoals; ++i) {
    const double angle_rad = random.uniform(-3.1, 3.1);
    lodestone::task::Observation seen;
    seen.pose = {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(-3.0, 3.0)};
    seen.target_m = seen.pose.position_m() +
                    0.004 * lodestone::geometry::Vector2(std::cos(angle_rad), std::sin(angle_rad));
    seen.last_action = {0.9, 0.9};
    seen.last_displacement_m = {0.009, 0.009};  // it came here
    const lodestone::geometry::Vector2 first = decide(seen);
    if ((kGain_m * 10.0 * first - (seen.target_m - seen.pose.position_m())).norm() < 0.0015) ++right;
    seen.last_action = first;
    seen.last_displacement_m.setZero();
    if ((decide(seen) - first).norm() > 0.15 * first.norm()) ++other;
  }
  CHECK(right > 0.8 * kGoals);
  CHECK(other > 0.8 * kGoals);
}

TEST_CASE("A learner down the gradient goes on bitwise, at any number of threads", "[rl]") {
  const ImaginedTask task = task_for(300);  // not a multiple of a shard
  const auto make = [&](std::int64_t threads) {
    return std::make_unique<ModelGradientLearner>(learning_for(30000), small_config(), task,
                                                  env_tests::noisy_linear_model(kGain_m), 1, threads);
  };
  const auto through = make(1);
  const auto first = make(3);
  for (int i = 0; i < 20; ++i) {
    through->step();
    first->step();
  }
  CHECK(same(through->actor_weights(), first->actor_weights()));
  Checkpoint checkpoint;
  first->save(checkpoint);
  const auto second = make(2);
  second->load(checkpoint);
  for (int i = 0; i < 20; ++i) {
    through->step();
    second->step();
  }
  CHECK(second->env_steps() == through->env_steps());
  CHECK(same(through->actor_weights(), second->actor_weights()));

  Checkpoint broken = checkpoint;
  broken.parts["running"].erase("needles");
  CHECK_THROWS_WITH(make(1)->load(broken), Catch::Contains("\"needles\" is missing"));
}

TEST_CASE("What has no gradient, and what is not imagined, is refused", "[rl]") {
  const auto start = [](const ImaginedTask& task, const lodestone::inference::DynamicsModel& model) {
    ModelGradientLearner(learning_for(1000), small_config(), task, model, 1, 1);
  };
  CHECK_THROWS_WITH(
      start(task_for(8), env_tests::linear_model(lodestone::data::StateLayout::kPose, {kGain_m}, {0.0})),
      Catch::Contains("model.components"));
  ImaginedTask pose = task_for(8);
  pose.task.goal = lodestone::task::GoalKind::kPose;
  CHECK_THROWS_WITH(start(pose, env_tests::noisy_linear_model(kGain_m)), Catch::Contains("task.goal"));
}
