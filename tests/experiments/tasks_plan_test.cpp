#include "lodestone/experiments/tasks_plan.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/physics/needle.h"
#include "sphere_rig.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

experiments::TasksScale small(const std::string& tasks = "", const std::string& controllers = "") {
  experiments::TasksScale scale;
  scale.trials = 2;
  scale.tasks = tasks;
  scale.models = "/models";
  if (!controllers.empty()) scale.controllers = controllers;
  return scale;
}

runs::Plan planned(const experiments::TasksScale& scale) {
  return experiments::tasks_plan(scale, physics::RigDescription(), "/run");
}

bool sets(const runs::Cell& cell, const std::string& setting) {
  return std::find(cell.settings.begin(), cell.settings.end(), setting) != cell.settings.end();
}

}  // namespace

TEST_CASE("every task has a cell for each controller that can do it, bare and decorated") {
  const runs::Plan plan = planned(small());
  CHECK_NOTHROW(plan.validate());
  CHECK(plan.name == "tasks");
  for (const char* task :
       {"pose", "pose_wide", "obstacles", "tangent_path/circle", "tangent_path/eight", "tangent_path/square",
        "still/point", "still/square", "flow/point", "flow/square", "square_at_mm_s/4", "square_at_mm_s/6"})
    for (const char* around : {"bare", "decorated"}) {
      CAPTURE(task, around);
      for (const char* controller : {"planner", "baseline"})
        CHECK(plan.find(std::string(task) + "/" + controller + "/" + around) != nullptr);
    }
  // Where headings are wanted, the policy for poses drives, and the planner goes by what it learned.
  CHECK(sets(*plan.find("obstacles/policy/bare"), "policy=/models/any_rig"));
  CHECK(sets(*plan.find("pose/policy/bare"), "policy=/models/any_pose"));
  CHECK(sets(*plan.find("pose/planner/bare"), "policy=/models/any_pose"));
  CHECK_FALSE(sets(*plan.find("obstacles/planner/bare"), "policy=/models/any_rig"));
  CHECK(plan.find("suture/policy/bare") != nullptr);
  const runs::Cell* turned = plan.find("pose/baseline/decorated");
  REQUIRE(turned != nullptr);
  CHECK(turned->config == "best/deploy_pose.json");
  CHECK(plan.find("pose/planner/decorated")->config == "best/deploy.json");
  CHECK(plan.find("pose/planner/bare")->config.empty());
}

TEST_CASE("cells say what their tasks are, and drive rigs that nobody has seen") {
  const runs::Plan plan = planned(small());
  for (const runs::Cell& cell : plan.cells) {
    CAPTURE(cell.id);
    const bool oracle = cell.id.find("/oracle/") != std::string::npos;
    CHECK(cell.verb == (oracle ? "bench oracle" : "deploy"));
    CHECK(sets(cell, "on_rig=unseen"));
    CHECK(sets(cell, "trials.count=2"));
    CHECK(sets(cell, oracle ? "sensor.kind=simulated" : "sensor.kind=camera"));
    CHECK(sets(cell, "dynamics=/models/dynamics_best"));
  }
  CHECK(sets(*plan.find("pose/planner/bare"), "score.success_radius_m=0.001"));
  CHECK(sets(*plan.find("pose/planner/bare"), "score.success_heading_deg=5.0"));
  CHECK(sets(*plan.find("pose_wide/planner/bare"), "rig.simulation.deviation=wide"));
  CHECK(sets(*plan.find("obstacles/planner/bare"), "trials.obstacles.count=3"));
  CHECK(sets(*plan.find("tangent_path/eight/planner/bare"), "task=/run/eight.csv"));
  CHECK(sets(*plan.find("tangent_path/circle/planner/bare"), "trials.path_heading=tangent"));
  CHECK(sets(*plan.find("flow/point/planner/bare"), "rig.simulation.flow.waveform=sine"));
  CHECK(sets(*plan.find("square_at_mm_s/6/planner/bare"), "reference.speed_m_s=0.006"));
  CHECK(sets(*plan.find("still/square/planner/bare"), "reference.speed_m_s=0.002"));
}

TEST_CASE("the oracle drives every task bare, by the planner's settings where these tell what is wanted") {
  experiments::TasksScale scale = small();
  scale.trials = 200;
  scale.oracle_trials = 7;
  const runs::Plan plan = planned(scale);
  CHECK_NOTHROW(plan.validate());
  for (const runs::Cell& cell : plan.cells) {
    if (cell.id.find("/planner/bare") == std::string::npos) continue;
    std::string id = cell.id;
    id.replace(id.find("planner"), 7, "oracle");
    CAPTURE(id);
    const runs::Cell* oracle = plan.find(id);
    REQUIRE(oracle != nullptr);
    CHECK(oracle->seed == cell.seed);
    CHECK(sets(*oracle, "trials.count=7"));
    for (const char* setting : {"policy=/models/any_pose", "planner.horizon=2", "trials.path_heading=tangent",
                                "planner.heading_cost_mm=4.2", "planner.heading_cost_mm=3.4",
                                "planner.heading_cost_mm=5", "trials.obstacles.count=3"})
      CHECK(sets(*oracle, setting) == sets(cell, setting));
    CHECK(plan.find(id.substr(0, id.size() - 4) + "decorated") == nullptr);
  }
}

TEST_CASE("what the planner is set to is what the presets for users say") {
  const runs::Plan plan = planned(small());
  for (const auto& [id, preset] : {std::pair{"pose", "deploy_any_pose"},
                                   {"tangent_path/circle", "deploy_headed_path"},
                                   {"tangent_path/eight", "deploy_headed_path"},
                                   {"suture", "deploy_suture"}}) {
    const common::Json planner =
        common::read_json_file(std::string(LODESTONE_SOURCE_DIR) + "/configs/best/" + preset + ".json")
            .at("planner");
    CHECK(planner.size() > 2);
    for (const auto& [key, value] : planner.items()) {
      CAPTURE(id, key);
      CHECK(sets(*plan.find(std::string(id) + "/planner/bare"), "planner." + key + "=" + value.dump()));
    }
  }
}

TEST_CASE("controllers and variants of a task meet the same trials, tasks others") {
  std::map<std::string, std::set<std::int64_t>> seeds;  // by deploy's task
  for (const runs::Cell& cell : planned(small()).cells)
    for (const std::string& setting : cell.settings)
      if (setting.rfind("task=", 0) == 0) seeds[setting].insert(*cell.seed);
  CHECK(seeds.size() >= 5);  // point, pose, circle, square, eight
  std::set<std::int64_t> all;
  for (const auto& [task, of_task] : seeds) {
    CAPTURE(task);
    CHECK(of_task.size() == 1);
    all.insert(of_task.begin(), of_task.end());
  }
  CHECK(all.size() == seeds.size());
  experiments::TasksScale other = small();
  other.seed = 2;
  CHECK(planned(other).cells.front().seed != planned(small()).cells.front().seed);
}

TEST_CASE("tasks and controllers are chosen by name, with what they are compared with") {
  const runs::Plan flow = planned(small("flow", "baseline"));
  CHECK(flow.cells.size() == 8);  // two tasks, and the same in fluid at rest
  CHECK(flow.find("still/point/baseline/bare") != nullptr);
  CHECK(planned(small("square_at_mm_s", "baseline")).find("still/square/baseline/bare") != nullptr);
  CHECK_THROWS_WITH(planned(small("triangle")), Catch::Contains("\"triangle\" is none of pose"));
  CHECK_THROWS_WITH(planned(small("pose,pose")), Catch::Contains("comes twice"));
  CHECK_THROWS_WITH(planned(small("", "magic")), Catch::Contains("\"magic\" is none of planner"));
}

TEST_CASE("the figure of eight is closed, lies in the dish and reads back from its file") {
  const tests::TemporaryFolder folder;
  const geometry::Path eight = experiments::figure_of_eight();
  CHECK(eight.closed());
  CHECK(eight.length_m() > 0.08);
  for (const geometry::Vector2& point_m : eight.points_m()) CHECK(point_m.norm() < 0.0151);
  CHECK(eight.nearest({0.0, 0.0}).distance_m < 1e-9);
  CHECK(eight.corners_m().empty());
  experiments::write_figure_of_eight(folder.path());
  const geometry::Path read = geometry::Path::from_csv(folder / "eight.csv");
  CHECK(read.closed());
  CHECK(read.length_m() == Approx(eight.length_m()).epsilon(1e-6));
}
