#include "lodestone/rl/td3_learner.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <ATen/ATen.h>

#include "lodestone/common/error.h"
#include "lodestone/rl/policy_evaluation.h"
#include "rl/toy_environments.h"

using lodestone::nets::Checkpoint;
using lodestone::rl::LearningConfig;
using lodestone::rl::NoiseConfig;
using lodestone::rl::NoiseKind;
using lodestone::rl::PolicyEvaluation;
using lodestone::rl::PolicyScore;
using lodestone::rl::Td3Config;
using lodestone::rl::Td3Learner;
using lodestone::rl::testing::BanditEnv;
using lodestone::rl::testing::PointEnv;

namespace {

Td3Config small_td3() {
  Td3Config config;
  config.hidden = {32, 32};
  config.batch_size = 64;
  config.learning_rate = 1e-3;
  return config;
}

LearningConfig short_learning(std::int64_t env_steps, double updates_per_step) {
  LearningConfig config;
  config.env_steps = env_steps;
  config.warm_up_steps = 200;
  config.updates_per_step = updates_per_step;
  config.final_learning_rate = 0.02;
  return config;
}

NoiseConfig gaussian(double sigma) {
  NoiseConfig config;
  config.kind = NoiseKind::kGaussian;
  config.sigma = sigma;
  return config;
}

/// The point environment, until it is spoiled.
class SpoiledEnv final : public lodestone::env::VecEnv {
 public:
  explicit SpoiledEnv(bool reward) : reward_(reward) {}
  lodestone::env::EnvSpec spec() const override { return point_.spec(); }
  const std::vector<float>& reset() override { return point_.reset(); }
  const lodestone::env::StepResult& step(const std::vector<float>& actions) override {
    result_ = point_.step(actions);
    if (spoiled) (reward_ ? result_.reward[1] : result_.final_observation[3]) = std::nanf("");
    return result_;
  }
  lodestone::env::Snapshot save() const override { return point_.save(); }
  void load(const lodestone::env::Snapshot& snapshot) override { point_.load(snapshot); }

  bool spoiled = false;

 private:
  PointEnv point_{4, 1};
  bool reward_;
  lodestone::env::StepResult result_;
};

bool same_state(Td3Learner& one, Td3Learner& two) {
  Checkpoint first;
  Checkpoint second;
  one.save(first);
  two.save(second);
  if (first.facts != second.facts || first.parts.size() != second.parts.size()) return false;
  for (const auto& [part, tensors] : first.parts) {
    for (const auto& [name, tensor] : tensors) {
      if (!at::equal(tensor, second.parts.at(part).at(name))) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("A bandit's best action is found, and its value", "[rl]") {
  BanditEnv bandit(8, 0.6F, -0.3F, 1, true);
  Td3Learner learner(short_learning(6000, 0.25), small_td3(), gaussian(0.4), 1, 1, bandit);
  while (!learner.finished()) learner.step();
  const std::vector<float> action = learner.td3().act({1.0F});
  const double off_x = action[0] - 0.6;
  const double off_y = action[1] + 0.3;
  CHECK(off_x * off_x + off_y * off_y < 0.02);  // lost reward, of 1
  CHECK(learner.updates() == 1450);
}

TEST_CASE("Overlapping environments and updates lag by one step, at any number of threads", "[rl]") {
  LearningConfig learning = short_learning(2000, 0.25);
  learning.overlap = true;
  PointEnv for_one(5, 1);
  PointEnv for_four(5, 1);
  Td3Learner one(learning, small_td3(), gaussian(0.4), 1, 1, for_one);
  Td3Learner four(learning, small_td3(), gaussian(0.4), 1, 4, for_four);
  for (int step = 0; step < 100; ++step) {
    one.step();
    four.step();
  }
  // 40 steps of warm-up, then 59 times 1.25 updates; those of the last step are still due
  CHECK(one.updates() == 73);
  CHECK(same_state(one, four));

  Checkpoint checkpoint;
  one.save(checkpoint);
  PointEnv for_resumed(5, 4321);
  Td3Learner resumed(learning, small_td3(), gaussian(0.4), 77, 2, for_resumed);
  resumed.load(checkpoint);
  while (!four.finished()) four.step();
  while (!resumed.finished()) resumed.step();
  CHECK(same_state(four, resumed));
}

TEST_CASE("Truncation bootstraps and termination does not", "[rl][slow]") {
  Td3Config td3 = small_td3();
  td3.discount = 0.8;
  td3.polyak_tau = 0.02;
  td3.policy_noise = 0.0;  // the smoothed value would be lower
  for (const bool terminates : {false, true}) {
    BanditEnv bandit(8, 0.0F, 0.0F, 1, terminates);
    Td3Learner learner(short_learning(8000, 0.5), td3, gaussian(0.1), 1, 1, bandit);
    while (!learner.finished()) {
      if (learner.env_steps() == 7200) learner.take_statistics();
      learner.step();
    }
    double value = 0.0;
    for (const auto& [key, number] : learner.take_statistics()) {
      if (key == "train/actor_loss") value = -number;  // value of the policy's own action
    }
    INFO("terminates " << terminates);
    CHECK(value == Approx(terminates ? 1.0 : 1.0 / (1.0 - td3.discount)).epsilon(0.03));
  }
}

TEST_CASE("The point task is solved to within 7 % of its best return", "[rl][slow]") {
  PointEnv training(16, 1);
  PointEnv evaluation(200, 77);
  PolicyEvaluation evaluate(evaluation, {});
  Td3Config td3 = small_td3();
  td3.policy_noise = 0.1;  // smoothing costs return here, where the best action changes within a stride
  Td3Learner learner(short_learning(80000, 0.4), td3, gaussian(0.2), 3, 2, training);
  const double before = evaluate.run(learner.td3().actor()).episode_return;
  while (!learner.finished()) learner.step();
  const PolicyScore score = evaluate.run(learner.td3().actor());
  PointEnv same(200, 77);
  const std::vector<float>& starts = same.reset();
  double best = 0.0;
  for (std::size_t i = 0; i < 200; ++i) {
    best += PointEnv::best_return(starts[2 * i], starts[2 * i + 1]) / 200.0;
  }
  INFO("best " << best << ", reached " << score.episode_return << ", untrained " << before);
  CHECK(score.episode_return <= best + 1e-4);
  CHECK(score.episode_return > 1.07 * best);  // returns are negative
  CHECK(before < 2.0 * best);
  CHECK(score.success_rate > 0.95);
}

TEST_CASE("2 N steps equal N, save, load and N, bitwise", "[rl]") {
  const auto make = [](PointEnv& env, std::uint64_t seed, std::int64_t threads) {
    LearningConfig learning = short_learning(2000, 0.2);
    learning.buffer_size = 300;  // the ring wraps
    learning.final_noise = 0.5;
    return Td3Learner(learning, small_td3(), NoiseConfig{}, seed, threads, env);
  };
  PointEnv env_whole(5, 1);
  PointEnv env_resumed(5, 4321);
  PointEnv env_two_threads(5, 1);
  Td3Learner whole = make(env_whole, 3, 1);
  Td3Learner two_threads = make(env_two_threads, 3, 2);
  for (int i = 0; i < 100; ++i) whole.step();
  Checkpoint checkpoint;
  whole.save(checkpoint);
  Td3Learner resumed = make(env_resumed, 999, 1);
  resumed.load(checkpoint);
  CHECK(same_state(whole, resumed));
  for (int i = 0; i < 100; ++i) {
    whole.step();
    resumed.step();
  }
  CHECK(whole.env_steps() == 1000);
  CHECK(whole.updates() == 160);
  CHECK(same_state(whole, resumed));
  for (int i = 0; i < 200; ++i) two_threads.step();
  CHECK(same_state(whole, two_threads));

  PointEnv env_other(6, 1);
  Td3Learner other = make(env_other, 3, 1);
  CHECK_THROWS_AS(other.load(checkpoint), lodestone::common::CheckpointError);
  checkpoint.parts.erase("running");
  CHECK_THROWS_AS(resumed.load(checkpoint), lodestone::common::CheckpointError);
}

TEST_CASE("Training stops where a reward or an observation stops being a number", "[rl]") {
  for (const bool reward : {true, false}) {
    SpoiledEnv environments(reward);
    Td3Learner learner(short_learning(4000, 0.25), small_td3(), gaussian(0.1), 1, 1, environments, {});
    for (int i = 0; i < 5; ++i) learner.step();
    environments.spoiled = true;
    CHECK_THROWS_WITH(learner.step(), Catch::Contains(reward ? "the reward of environment 1 is nan"
                                                             : "the observation of environment 1 is nan") &&
                                          Catch::Contains("after 20 environment steps"));
  }
}
