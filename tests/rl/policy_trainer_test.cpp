#include "lodestone/rl/policy_trainer.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <ATen/ATen.h>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/policy_evaluation.h"
#include "lodestone/rl/td3_learner.h"
#include "rl/toy_environments.h"
#include "sphere_rig.h"
#include "temporary_folder.h"

using lodestone::common::artefact_to_json;
using lodestone::common::Json;
using lodestone::rl::train_policy;
using lodestone::rl::TrainPolicyConfig;
using lodestone::rl::testing::PointEnv;
using lodestone::runs::PolicyResult;

namespace {

/// A name that is free, in a folder that goes away.
std::string fresh_folder(const std::string& name) {
  static const lodestone::tests::TemporaryFolder
      root;  // not the working folder, which may be the source tree
  return root / name;
}

/// The point environment's observation is a position in units of the length scale, its goal the centre.
TrainPolicyConfig point_config(std::int64_t env_steps) {
  TrainPolicyConfig config;
  config.threads = 1;
  config.encoder.heading = lodestone::task::HeadingEncoding::kNone;
  config.encoder.target = false;
  config.encoder.length_scale_m = 1.0;
  config.action.scale = 1.0;
  config.task.goal = lodestone::task::GoalKind::kCentre;
  config.td3.hidden = {16, 16};
  config.td3.batch_size = 32;
  config.training.learning.env_steps = env_steps;
  config.training.learning.warm_up_steps = 200;
  config.training.learning.updates_per_step = 0.2;
  config.training.evaluate_every = 400;
  config.training.environments = 8;
  config.training.evaluation_episodes = 20;
  config.training.checkpoint_every_s = 1e6;
  return config;
}

constexpr std::uint64_t kChoiceSeed = 2;
constexpr std::uint64_t kFreshSeed = 3;

/// One that learns what poses cost beside its policy.
class WithCostToGo final : public lodestone::rl::PolicyLearner {
 public:
  explicit WithCostToGo(lodestone::rl::PolicyLearner& learner) : learner_(learner) {}
  void step() override { learner_.step(); }
  std::int64_t env_steps() const override { return learner_.env_steps(); }
  std::int64_t updates() const override { return learner_.updates(); }
  bool finished() const override { return learner_.finished(); }
  lodestone::inference::Actor actor() const override { return learner_.actor(); }
  lodestone::inference::Arrays actor_weights() const override { return learner_.actor_weights(); }
  std::optional<lodestone::inference::CostToGo> cost_to_go() const override {
    using lodestone::inference::CostToGo;
    const std::vector<float> row(static_cast<std::size_t>(CostToGo::kFeatures));
    // It says how many steps it has seen.
    const std::vector<float> steps = {static_cast<float>(env_steps())};
    lodestone::inference::PoseCost cost;
    cost.dish_radius_m = 0.0425;
    return CostToGo({{"l1.weight", {row, {1, CostToGo::kFeatures}}},
                     {"l1.bias", {std::vector<float>{0.0F}, {1}}},
                     {"l2.weight", {std::vector<float>{0.0F}, {1, 1}}},
                     {"l2.bias", {steps, {1}}}},
                    {1}, cost);
  }
  lodestone::common::Scalars take_statistics() override { return learner_.take_statistics(); }
  void save(lodestone::nets::Checkpoint& checkpoint) override { learner_.save(checkpoint); }
  void load(const lodestone::nets::Checkpoint& checkpoint) override { learner_.load(checkpoint); }

 private:
  lodestone::rl::PolicyLearner& learner_;
};

PolicyResult run(const TrainPolicyConfig& config, const std::string& folder, bool resume = false,
                 bool with_cost_to_go = false) {
  PointEnv training(config.training.environments, 1);
  PointEnv choice(config.training.evaluation_episodes, kChoiceSeed);
  PointEnv fresh(config.training.evaluation_episodes, kFreshSeed);
  lodestone::runs::RunFolder run_folder(lodestone::rl::run_request(config, folder, resume));
  lodestone::rl::Td3Learner learner(config.training.learning, config.td3, config.noise,
                                    static_cast<std::uint64_t>(config.seed), 1, training);
  WithCostToGo both(learner);
  lodestone::rl::PolicyLearner& learns =
      with_cost_to_go ? static_cast<lodestone::rl::PolicyLearner&>(both) : learner;
  const PolicyResult result = train_policy(config, learns, {choice, fresh}, run_folder);
  run_folder.finish();
  return result;
}

/// The policy that a run has kept, in the episodes of a seed.
Json score_of_kept(const std::string& folder, const TrainPolicyConfig& config, std::uint64_t seed) {
  PointEnv environments(config.training.evaluation_episodes, seed);
  lodestone::rl::PolicyEvaluation evaluate(environments, config.encoder);
  return artefact_to_json(evaluate.run(lodestone::inference::load_policy(folder + "/checkpoint").actor()));
}

int count_lines_with(const std::string& file, const std::string& text) {
  const std::string content = lodestone::common::read_file(file);
  int count = 0;
  for (std::size_t at = content.find(text); at != std::string::npos; at = content.find(text, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("A run leaves its best policy, its curves and its figures", "[rl]") {
  const std::string folder = fresh_folder("whole");
  const PolicyResult result = run(point_config(2000), folder);
  CHECK(result.env_steps == 2000);
  CHECK(result.updates == 360);
  CHECK(result.best_env_steps >= 400);
  REQUIRE(result.fresh_evaluation);
  CHECK(result.fresh_evaluation->episodes == 20);
  CHECK(result.seconds_to_95_percent > 0.0);
  CHECK(result.seconds_to_95_percent <= result.train_seconds);
  CHECK(result.peak_memory_mb > 10.0);
  REQUIRE(result.other_processor_seconds);
  CHECK(*result.other_processor_seconds >= 0.0);
  CHECK(count_lines_with(folder + "/metrics.jsonl", "\"step\":0,") == 1);  // the untrained policy
  for (const char* key :
       {"evaluation/success_rate", "evaluation/episode_end_error_mm", "train/critic_loss", "train/q_mean",
        "train/action_saturation", "train/steps_per_s", "train/episode_return"}) {
    INFO(key);
    CHECK(count_lines_with(folder + "/metrics.jsonl", std::string("\"") + key + "\"") >= 4);
  }
  const lodestone::inference::Policy policy = lodestone::inference::load_policy(folder + "/checkpoint");
  CHECK(policy.goal == "centre");
  CHECK_FALSE(policy.encoder.target);
  const std::vector<float> observation = {0.9F, 0.9F};
  float action[2];
  lodestone::inference::Actor::Workspace workspace;
  policy.actor().act(observation.data(), 1, action, workspace);
  for (const float component : action) CHECK(std::abs(component) <= 1.0F);
}

TEST_CASE("Where a cost-to-go is learned, the latest is kept, however its policy scored", "[rl]") {
  TrainPolicyConfig config = point_config(2000);
  config.training.evaluate_every = 100;  // so that one before the last is likely to score as high
  const std::string folder = fresh_folder("costs");
  const PolicyResult alone = run(config, fresh_folder("alone"));
  CHECK(alone.best_env_steps < alone.env_steps);  // a chosen one
  const PolicyResult result = run(config, folder, false, true);
  CHECK(result.best_env_steps == result.env_steps);
  const lodestone::inference::Policy kept = lodestone::inference::load_policy(folder + "/checkpoint");
  REQUIRE(kept.cost_to_go);
  CHECK(kept.cost_to_go->weights().at("l2.bias").to_vector<float>().front() == 2000.0F);
}

TEST_CASE("What is reported of the policy that is kept is from episodes that nothing was chosen by", "[rl]") {
  const std::string folder = fresh_folder("reported");
  const TrainPolicyConfig config = point_config(2000);
  const PolicyResult result = run(config, folder);
  REQUIRE(result.best_evaluation);
  REQUIRE(result.fresh_evaluation);
  CHECK(artefact_to_json(*result.best_evaluation) == score_of_kept(folder, config, kChoiceSeed));
  CHECK(artefact_to_json(*result.fresh_evaluation) == score_of_kept(folder, config, kFreshSeed));
  CHECK(result.fresh_evaluation->episode_return != result.best_evaluation->episode_return);
  const Json metrics =
      lodestone::inference::load_checkpoint(folder + "/checkpoint", "policy").facts["metrics"];
  CHECK(metrics["env_steps"] == result.best_env_steps);
  CHECK(metrics["best_evaluation"] == artefact_to_json(*result.best_evaluation));
  CHECK(metrics["fresh_evaluation"] == artefact_to_json(*result.fresh_evaluation));
}

TEST_CASE("An interrupted run goes on to the same weights, and to the same score", "[rl]") {
  const std::string whole = fresh_folder("uninterrupted");
  const std::string part = fresh_folder("interrupted");
  const PolicyResult expected = run(point_config(1600), whole);
  TrainPolicyConfig config = point_config(1600);
  config.training.max_seconds = 1e-6;  // stops at its first look, long before the end
  CHECK(run(config, part).env_steps < 1600);
  config.training.max_seconds = 0.0;
  config.threads = 2;
  const PolicyResult resumed = run(config, part, true);
  CHECK(resumed.env_steps == expected.env_steps);
  CHECK(resumed.updates == expected.updates);
  CHECK(artefact_to_json(*resumed.best_evaluation) == artefact_to_json(*expected.best_evaluation));
  CHECK(artefact_to_json(*resumed.fresh_evaluation) == artefact_to_json(*expected.fresh_evaluation));
  CHECK(count_lines_with(part + "/metrics.jsonl", "\"step\":0,") == 1);
  const auto one = lodestone::nets::load_checkpoint(whole + "/training", "policy_training");
  const auto two = lodestone::nets::load_checkpoint(part + "/training", "policy_training");
  CHECK(one.facts.at("td3") == two.facts.at("td3"));
  for (const char* part_name : {"networks", "optimiser", "buffer", "environments", "running"}) {
    for (const auto& [name, tensor] : one.parts.at(part_name)) {
      INFO(part_name << " " << name);
      CHECK(at::equal(tensor, two.parts.at(part_name).at(name)));
    }
  }
}

TEST_CASE("A finished run trains on when it is given more steps", "[rl]") {
  const std::string folder = fresh_folder("longer");
  const PolicyResult first = run(point_config(800), folder);
  const PolicyResult longer = run(point_config(1600), folder, true);
  CHECK(longer.env_steps == 1600);
  CHECK(longer.updates > first.updates);
  CHECK(count_lines_with(folder + "/metrics.jsonl", "\"step\":800,") == 1);
  CHECK(count_lines_with(folder + "/metrics.jsonl", "\"step\":1600,") == 1);
}

TEST_CASE("Resuming with other settings, or from an altered checkpoint, is refused", "[rl]") {
  const std::string folder = fresh_folder("refused");
  run(point_config(800), folder);
  TrainPolicyConfig other = point_config(800);
  other.td3.discount = 0.9;
  CHECK_THROWS_AS(run(other, folder, true), lodestone::common::ConfigError);
  const std::string older = fresh_folder("older");
  run(point_config(800), older);
  auto training = lodestone::nets::load_checkpoint(older + "/training", "policy_training");
  training.facts["run"]["best"].erase("episode_end_error_mm");
  lodestone::nets::save_checkpoint(older + "/training", training);
  CHECK_THROWS_WITH(run(point_config(1600), older, true),
                    Catch::Contains("of another version") && Catch::Contains("episode_end_error_mm"));
  std::string content = lodestone::common::read_file(folder + "/training/networks.safetensors");
  content[content.size() / 2] ^= 1;
  lodestone::common::write_file_atomically(folder + "/training/networks.safetensors", content);
  CHECK_THROWS_AS(run(point_config(800), folder, true), lodestone::common::CheckpointError);
}

TEST_CASE("What the data say goes into the policy's configuration", "[rl]") {
  lodestone::data::DatasetInfo info;
  info.layout = lodestone::data::StateLayout::kPosition;
  info.action_scale = 89.0;
  info.workspace_radius_m = 0.014;
  info.one_axis_at_a_time = true;
  TrainPolicyConfig config = lodestone::rl::adopt_data(TrainPolicyConfig{}, info);
  CHECK(config.action.scale == 89.0);
  CHECK(config.action.one_axis_at_a_time);
  CHECK(config.task.dish_radius_m == 0.014);
  CHECK(config.encoder.length_scale_m == 0.014);
  CHECK(config.encoder.heading == lodestone::task::HeadingEncoding::kNone);
}

TEST_CASE("A policy for a sphere sees no heading, and is not asked for one", "[rl]") {
  TrainPolicyConfig config;
  config.rig = lodestone::tests::sphere_rig();
  config.encoder.heading = lodestone::task::HeadingEncoding::kSineCosine;
  CHECK(lodestone::rl::adopt_rig(config).encoder.heading == lodestone::task::HeadingEncoding::kNone);
  config.task.goal = lodestone::task::GoalKind::kPose;
  CHECK_THROWS_WITH(lodestone::rl::adopt_rig(config), Catch::Contains("a sphere has no heading"));
  config.rig = {};
  CHECK(lodestone::rl::adopt_rig(config).encoder.heading == lodestone::task::HeadingEncoding::kSineCosine);
}

TEST_CASE("A run without room to learn is refused", "[rl]") {
  TrainPolicyConfig config = point_config(100);
  CHECK_THROWS_AS(config.validate(), lodestone::common::ConfigError);
  config = point_config(1000);
  CHECK_NOTHROW(config.validate());
  config.training.learning.buffer_size = 10;
  CHECK_THROWS_AS(config.validate(), lodestone::common::ConfigError);
}
