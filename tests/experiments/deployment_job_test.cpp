#include "lodestone/experiments/deployment_job.h"

#include <catch2/catch.hpp>

#include "inference/random_policy.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "paper_rig.h"
#include "temporary_folder.h"

using namespace lodestone;
using experiments::DeployConfig;
using experiments::RigKind;

namespace {

DeployConfig by_baseline() {
  DeployConfig config;
  config.controller = "baseline";
  return config;
}

/// A checkpoint of a policy for `goal`.
std::string saved_policy(const tests::TemporaryFolder& folder, const std::string& goal) {
  inference::Policy policy;
  policy.encoder = tests::paper_encoder();
  policy.action = tests::paper_action();
  policy.goal = goal;
  tests::draw_weights(policy, 3);
  inference::save_policy(folder / goal, policy, common::Json::object(), common::Json::object());
  return folder / goal;
}

}  // namespace

TEST_CASE("tasks and rigs are what was asked for") {
  DeployConfig config = by_baseline();
  auto job = experiments::plan_job(config);
  CHECK(job.tasks == std::vector<std::string>{"centre", "point", "square", "circle"});
  CHECK(job.rigs == std::vector<RigKind>{RigKind::kExplored});
  CHECK(job.sources.front().name == "baseline");
  config.task = "square";
  config.on_rig = "both";
  job = experiments::plan_job(config);
  CHECK(job.tasks == std::vector<std::string>{"square"});
  CHECK(job.rigs == std::vector<RigKind>{RigKind::kExplored, RigKind::kUnseen});
  config.deployment.rig.backend = rig::Backend::kSerial;
  CHECK(experiments::plan_job(config).rigs == std::vector<RigKind>{RigKind::kReal});
}

TEST_CASE("a path is read from its file, and must lie in the dish") {
  const tests::TemporaryFolder folder;
  DeployConfig config = by_baseline();
  config.task = folder / "way.csv";
  common::write_file_atomically(config.task, "x_m,y_m\n0,0\n0.01,0\n0.01,0.01\n");
  const auto job = experiments::plan_job(config);
  CHECK(job.tasks == std::vector<std::string>{"path"});
  CHECK(job.path);
  common::write_file_atomically(config.task, "x_m,y_m\n0,0\n1,0\n");
  CHECK_THROWS_AS(experiments::plan_job(config), common::ConfigError);
}

TEST_CASE("what cannot be driven is refused in words") {
  DeployConfig config = by_baseline();
  config.task = "triangle";
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("triangle"));
  config.task = "point";
  config.target_mm = {900.0, 0.0};
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("target_mm"));
  config.target_mm = {1.0};
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("1 numbers"));
  config.target_mm.clear();
  config.controller = "policy";
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("--policy DIR is missing"));
  config.controller = "planner";
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("dynamics=DIR is missing"));
  config.controller = "baseline";
  config.deployment.trials.within = task::Within::kReachable;
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("reachable"));
}

TEST_CASE("what lies in a zone to keep out of is refused, and points are gone to by ways around zones") {
  DeployConfig config = by_baseline();
  config.task = "point";
  CHECK_FALSE(experiments::plan_job(config).routes);
  config.deployment.safety.keep_out = {{"vessel", {0.0, 0.0}, 0.004}};
  CHECK(experiments::plan_job(config).routes);
  config.target_mm = {3.0, 0.0};
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("target_mm") && Catch::Contains("vessel"));
  config.target_mm = {20.0, 0.0};
  CHECK(experiments::plan_job(config).target_m);
  config.task = "centre";
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("centre"));
  config.task = "square";
  CHECK(experiments::plan_job(config).tasks.size() == 1);  // around it
  config.deployment.safety.keep_out = {{"vessel", {0.015, 0.0}, 0.004}};
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("square_side_m"));
}

TEST_CASE("a policy drives to what it was trained for") {
  const tests::TemporaryFolder folder;
  DeployConfig config;
  config.policy = saved_policy(folder, "centre");
  auto job = experiments::plan_job(config);
  CHECK(job.tasks == std::vector<std::string>{"centre"});
  REQUIRE(job.sources.size() == 2);
  CHECK(job.sources[0].name == "policy");
  CHECK(job.sources[1].name == "baseline");
  config.task = "square";
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("trained for goal \"centre\""));
  config.policy = saved_policy(folder, "point");
  CHECK(experiments::plan_job(config).tasks == std::vector<std::string>{"square"});
}
