#include "lodestone/experiments/trial_obstacles.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/recorder.h"
#include "lodestone/experiments/routing.h"
#include "sphere_rig.h"
#include "temporary_folder.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

experiments::DeploymentConfig with_obstacles(std::int64_t count) {
  experiments::DeploymentConfig config;
  config.sensor.kind = "simulated";
  config.trials.obstacles.count = count;
  return config;
}

experiments::TrialPlan plan(const experiments::DeploymentConfig& config, const std::string& task,
                            std::int64_t index, const std::optional<Vector2>& target_m = {},
                            std::shared_ptr<const task::RouteMap> routes = nullptr) {
  return experiments::plan_trial(
      config, task, index, target_m, std::nullopt, [](const geometry::Pose2&) { return true; }, nullptr,
      std::move(routes));
}

/// A map that knows of one row of cells along the x axis, and of no other way.
std::shared_ptr<const task::RouteMap> corridor() {
  const task::RouteConfig config;
  std::vector<task::Move> moves;
  for (double x_m = -0.038; x_m < 0.034; x_m += config.region.cell_m)
    for (int i = 0; i < 100; ++i) {
      moves.push_back({{x_m, 0.002}, {x_m + config.region.cell_m, 0.002}});
      moves.push_back({{x_m + config.region.cell_m, 0.002}, {x_m, 0.002}});
    }
  return std::make_shared<const task::RouteMap>(task::Region::disc(0.0425, config.region.cell_m), moves,
                                                config);
}

}  // namespace

TEST_CASE("obstacles are drawn for each trial, clear of its start and target, and change neither") {
  const auto config = with_obstacles(3);
  for (const char* task : {"point", "pose"}) {
    for (int index = 0; index < 20; ++index) {
      CAPTURE(task, index);
      const experiments::TrialPlan drawn = plan(config, task, index);
      const experiments::TrialPlan without = plan(with_obstacles(0), task, index);
      CHECK(without.obstacles.empty());
      CHECK(drawn.start.x_m == without.start.x_m);
      CHECK(drawn.start.heading_rad == without.start.heading_rad);
      CHECK(drawn.target_m == without.target_m);
      CHECK(drawn.target_heading_rad == without.target_heading_rad);
      REQUIRE(drawn.obstacles.size() == 3);
      REQUIRE(drawn.keep_out.zones.size() == 3);
      const double clearance_m = config.route.clearance_m;
      CHECK(drawn.keep_out.clearance_m(drawn.start) > drawn.keep_out.margin_m + clearance_m);
      CHECK(drawn.keep_out.clearance_m(drawn.target_m, drawn.target_m) >
            drawn.keep_out.any_way_m() + clearance_m);
      for (const physics::ObstacleConfig& disc : drawn.obstacles) {
        CHECK(disc.radius_m == Approx(0.003));
        CHECK(disc.reach_m() <= config.rig.dish.radius_m);
      }
      CHECK(drawn.obstacles[0].centre_m == plan(config, task, index).obstacles[0].centre_m);
    }
  }
  CHECK(plan(config, "point", 0).obstacles[0].centre_m != plan(config, "point", 1).obstacles[0].centre_m);
  // More of them begin with the same ones.
  CHECK(plan(with_obstacles(5), "point", 0).obstacles[2].centre_m ==
        plan(config, "point", 0).obstacles[2].centre_m);
}

TEST_CASE("they come after the zones that every trial has") {
  auto config = with_obstacles(2);
  config.safety.keep_out = {{"vessel", {0.0, 0.0}, 0.002}};
  const experiments::TrialPlan drawn = plan(config, "point", 0);
  REQUIRE(drawn.keep_out.zones.size() == 3);
  CHECK(drawn.keep_out.zones[0].called() == "vessel");
  CHECK(drawn.keep_out.zones[2].called() == "obstacle 2");
  CHECK(drawn.keep_out.zones[2].corners_m == drawn.obstacles[1].centre_m);
}

TEST_CASE("obstacles that cannot be are refused in one line") {
  experiments::TrialObstaclesConfig config;
  rig::RigConfig rig;
  CHECK_NOTHROW(experiments::check_obstacles(config, rig, "square"));
  config.count = 3;
  CHECK_NOTHROW(experiments::check_obstacles(config, rig, "pose"));
  CHECK_THROWS_WITH(experiments::check_obstacles(config, rig, "square"),
                    Catch::Contains("trials.obstacles.count = 3") && Catch::Contains("point or pose"));
  CHECK_THROWS_AS(plan(with_obstacles(1), "circle", 0), common::ConfigError);
  rig.backend = rig::Backend::kSerial;
  CHECK_THROWS_WITH(experiments::check_obstacles(config, rig, "point"), Catch::Contains("virtual rig"));
  rig.backend = rig::Backend::kVirtual;
  rig.needle = tests::sphere();
  CHECK_THROWS_WITH(experiments::check_obstacles(config, rig, "point"), Catch::Contains("a sphere"));
  rig = {};
  config.diameter_m = 0.09;
  CHECK_THROWS_WITH(experiments::check_obstacles(config, rig, "point"), Catch::Contains("diameter_m"));
  auto crowded = with_obstacles(1);
  crowded.trials.obstacles.diameter_m = 0.08;  // fits the dish, but nowhere beside start and target
  CHECK_THROWS_WITH(plan(crowded, "point", 0), Catch::Contains("clear of start and target"));
}

TEST_CASE("they are solid in the trial's rig, and the supervisor keeps the needle out of them") {
  auto config = with_obstacles(1);
  config.trials.point_seconds = 20.0;
  experiments::TrialPlan through = plan(config, "point", 0, Vector2(0.025, 0.0));
  through.start = {-0.025, 0.0, 0.5 * geometry::kPi};
  physics::ObstacleConfig disc;
  disc.centre_m = {0.0, 0.0};
  disc.radius_m = 0.003;
  through.obstacles = {disc};
  through.keep_out.zones = {experiments::zone_of(disc, "obstacle 1")};
  experiments::TrialPlan untold = through;
  untold.keep_out.zones.clear();
  untold.obstacles.clear();
  auto unguarded = config;
  unguarded.rig.simulation.obstacles = {disc};
  const experiments::Deployment deployment(config);
  const auto source = experiments::baseline_source(config);
  common::ThreadPool pool(2);
  auto results = deployment.run({through, untold}, experiments::RigKind::kExplored, source, pool);
  results.insert(results.begin() + 1, experiments::Deployment(unguarded).run(
                                          {untold}, experiments::RigKind::kExplored, source, pool)[0]);
  CHECK_FALSE(results[0].completed);
  CHECK_THAT(results[0].stop_reason, Catch::Contains("keep-out zone obstacle 1"));
  const auto least_m = [&through](const experiments::TrialResult& result) {
    double least = 1.0;
    for (const auto& sample : result.samples)
      least = std::min(least, through.keep_out.clearance_m(*sample.true_pose));
    return least;
  };
  CHECK(results[1].completed);         // it leans on the disc, and nobody minds
  CHECK(least_m(results[1]) > -5e-4);  // its ends are round, and zones are measured as if they were not
  CHECK(least_m(results[2]) < -5e-4);  // where there is none it goes through
}

namespace {

/// Does something once it is asked for the first time.
class Telling final : public control::Controller {
 public:
  explicit Telling(std::function<void()> tell) : tell_(std::move(tell)) {}
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    if (tell_) std::exchange(tell_, nullptr)();
    return observation.rest();
  }

 private:
  std::function<void()> tell_;
};

}  // namespace

TEST_CASE("zones that a file tells stand beside a trial's obstacles, and move while it is driven") {
  const tests::TemporaryFolder folder;
  auto config = with_obstacles(1);
  config.safety.keep_out_file = folder / "moving.json";
  config.trials.point_seconds = 3.0;
  const auto tell = [&config](const std::string& name) {
    common::write_file_atomically(
        config.safety.keep_out_file,
        R"({"keep_out": [{"name": ")" + name + R"(", "corners_m": [0.9, 0.0], "radius_m": 0.002}]})");
  };
  tell("first");
  experiments::ControllerSource source = experiments::baseline_source(config);
  source.make = [&](std::uint64_t) { return std::make_unique<Telling>([&] { tell("second"); }); };
  common::ThreadPool pool(1);
  const auto result = experiments::Deployment(config).run(
      {plan(config, "point", 0, std::nullopt, experiments::route_map(config, nullptr, nullptr))},
      experiments::RigKind::kExplored, source, pool)[0];
  CHECK(result.completed);
  REQUIRE(result.told_zones.size() == 2);
  for (const experiments::ToldZones& told : result.told_zones) {
    REQUIRE(told.zones.size() == 2);
    CHECK(told.zones.front().name == "obstacle 1");
  }
  CHECK(result.told_zones.front().zones.back().name == "first");
  CHECK(result.told_zones.back().zones.back().name == "second");
  CHECK(result.told_zones.back().time_s < 1.0);
  CHECK(result.plan.keep_out.zones == result.told_zones.front().zones);
}

TEST_CASE("a trial whose obstacles leave no way is not driven, failed, and counted as such") {
  auto config = with_obstacles(3);
  config.trials.point_seconds = 3.0;
  config.trials.start_radius = config.trials.goal_radius = 0.6;
  const auto routes = corridor();
  std::vector<experiments::TrialPlan> plans;
  for (int index = 0; index < 3000 && plans.size() < 2; ++index) {
    const experiments::TrialPlan drawn = plan(config, "point", index, Vector2(0.03, 0.002), routes);
    const bool beside_the_row = std::abs(drawn.start.y_m - 0.002) < 0.004;
    if (beside_the_row && drawn.unreachable == plans.empty() && plans.size() < 2) plans.push_back(drawn);
  }
  REQUIRE(plans.size() == 2);  // one with an obstacle on the row, and one without
  CHECK_FALSE(plan(with_obstacles(0), "point", 0, Vector2(0.03, 0.002), routes).unreachable);
  const experiments::Deployment deployment(config);
  common::ThreadPool pool(2);
  const auto results =
      deployment.run(plans, experiments::RigKind::kUnseen, experiments::baseline_source(config), pool);
  std::vector<runs::TrialRecord> records;
  for (const auto& result : results) records.push_back(experiments::record_of(result));
  CHECK_FALSE(records[0].completed);
  CHECK_THAT(records[0].stop_reason, Catch::Contains("no way leads from"));
  CHECK(records[0].time_s.size() == 1);
  CHECK_FALSE(records[0].truth->success);
  CHECK(records[0].unreachable == true);
  REQUIRE(records[0].obstacles_mm);
  CHECK(records[0].obstacles_mm->size() == 3);
  CHECK(records[0].obstacles_mm->front()[2] == Approx(3.0));
  CHECK(records[1].unreachable == false);
  CHECK(records[1].time_s.size() > 1);
  const runs::TaskSummary summary = experiments::summarise_task(records);
  CHECK(summary.unreachable == 1);
}

TEST_CASE("ways are searched where trials have obstacles") {
  CHECK(experiments::route_map(with_obstacles(1), nullptr, nullptr));
  CHECK_FALSE(experiments::route_map(with_obstacles(0), nullptr, nullptr));
}
