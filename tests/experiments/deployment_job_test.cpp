#include "lodestone/experiments/deployment_job.h"

#include <catch2/catch.hpp>

#include "inference/random_policy.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "paper_rig.h"
#include "sphere_rig.h"
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

TEST_CASE("the observer needs neither policy nor simulator, and is not identified") {
  DeployConfig config;
  config.controller = "observer";
  config.deployment.turn.current_A = 1.0;
  const auto job = experiments::plan_job(config);
  REQUIRE(job.sources.size() == 1);
  CHECK(job.sources.front().name == "observer");
  CHECK(job.sources.front().action.scale == config.deployment.rig.coils.max_current_A);
  CHECK_FALSE(job.sources.front().identify);
  CHECK(job.sources.front().make(1)->clone() != nullptr);
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

TEST_CASE("headings of a path are looked for before anything is driven") {
  const tests::TemporaryFolder folder;
  DeployConfig config = by_baseline();
  config.deployment.trials.path_heading = geometry::HeadingRule::kColumn;
  config.task = folder / "way.csv";
  common::write_file_atomically(config.task, "x_m,y_m\n0,0\n0.01,0\n");
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("trials.path_heading = \"column\""));
  common::write_file_atomically(config.task, "x_m,y_m,heading_rad\n0,0,0.5\n0.01,0,1\n");
  CHECK(experiments::plan_job(config).path->heading().rule() == geometry::HeadingRule::kColumn);
  config.task = "square";
  CHECK_THROWS_AS(experiments::plan_job(config), common::ConfigError);
  config.task = "all";
  CHECK_THROWS_AS(experiments::plan_job(config), common::ConfigError);
  config.task = "pose";
  CHECK_NOTHROW(experiments::plan_job(config));  // there is no path
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

TEST_CASE("a sphere goes to points, by what knows of no heading") {
  const tests::TemporaryFolder folder;
  DeployConfig config = by_baseline();
  config.deployment.rig.needle = tests::sphere();
  for (const char* task : {"pose", "suture"}) {
    config.task = task;
    CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains(task) && Catch::Contains("a sphere"));
  }
  config.task = "point";
  config.target_mm = {0.0, 40.9};  // nearer to the wall than a needle comes
  CHECK_NOTHROW(experiments::plan_job(config));
  config.target_mm = {0.0, 41.1};
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("stays 1.5 mm from the wall"));
  config.target_mm.clear();
  config.task = "circle";
  CHECK_NOTHROW(experiments::plan_job(config));
  config.deployment.trials.path_heading = geometry::HeadingRule::kTangent;
  CHECK_THROWS_WITH(experiments::plan_job(config),
                    Catch::Contains("trials.path_heading = \"tangent\" must be none: a sphere"));
  config.deployment.trials.path_heading = geometry::HeadingRule::kNone;
  config.task = "point";
  config.controller = "policy";
  config.policy = saved_policy(folder, "point");
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("the policy goes by a heading"));
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

TEST_CASE("obstacles of every trial need a point and a virtual rig, and ways around them") {
  DeployConfig config = by_baseline();
  config.deployment.trials.obstacles.count = 3;
  CHECK_THROWS_WITH(experiments::plan_job(config),
                    Catch::Contains("trials.obstacles.count = 3"));  // all tasks
  config.task = "pose";
  CHECK(experiments::plan_job(config).routes);
  config.deployment.rig.backend = rig::Backend::kSerial;
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("virtual rig"));
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
  config.policy = saved_policy(folder, "pose");
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("trained for goal \"pose\""));
  config.deployment.trials.path_heading = geometry::HeadingRule::kTangent;  // a pose after the other
  CHECK(experiments::plan_job(config).tasks == std::vector<std::string>{"square"});
}

TEST_CASE("a suture is looked at before anything is driven, and driven by what can turn a needle") {
  const tests::TemporaryFolder folder;
  DeployConfig config = by_baseline();
  config.task = "suture";
  CHECK(experiments::plan_job(config).tasks == std::vector<std::string>{"suture"});
  config.deployment.trials.path_heading = geometry::HeadingRule::kColumn;  // of paths
  CHECK_NOTHROW(experiments::plan_job(config));
  config.deployment.trials.suture.length_m = 0.07;
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("stitch 1") && Catch::Contains("wall"));
  config.deployment.trials.suture.length_m = 0.006;
  config.deployment.safety.keep_out = {{"vessel", {0.0, 0.0}, 0.0005}};
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("stitch 3") && Catch::Contains("vessel"));
  config.deployment.safety.keep_out.clear();
  config.controller = "policy";
  config.policy = saved_policy(folder, "pose");
  CHECK_NOTHROW(experiments::plan_job(config));
  config.policy = saved_policy(folder, "point");
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("trained for goal \"point\""));
  config.deployment.turn.current_A = 1.5;
  CHECK_NOTHROW(experiments::plan_job(config));
  config.policy = saved_policy(folder, "centre");
  CHECK_THROWS_WITH(experiments::plan_job(config), Catch::Contains("trained for goal \"centre\""));
}
