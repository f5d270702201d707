#include "lodestone/experiments/deployment_run.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "experiments/oblique.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// Two steps that depend on the plan alone.
experiments::TrialResult drive_one(const experiments::TrialPlan& plan, experiments::RigKind kind,
                                   const experiments::ControllerSource& source) {
  experiments::TrialResult result;
  result.plan = plan;
  result.rig = experiments::to_string(kind);
  result.controller = source.name;
  for (int i = 0; i < 2; ++i) {
    experiments::TrialSample sample;
    sample.step.time_s = 0.3 * i;
    sample.true_pose = plan.start;
    result.samples.push_back(sample);
  }
  const double error_mm = 1e3 * plan.start.position_m().norm();
  result.truth.emplace();
  result.truth->final_error_mm = error_mm;
  result.sensed = *result.truth;
  result.completed = true;
  return result;
}

/// Drives, and is killed before trial `dies_at` (counted from the driver's first).
experiments::TrialDriver fake_driver(int dies_at = -1, const std::string& stopped = "") {
  experiments::TrialDriver driver;
  driver.drive = [dies_at, count = 0](const std::vector<experiments::TrialPlan>& plans,
                                      experiments::RigKind kind, const experiments::ControllerSource& source,
                                      const experiments::TrialWatch&) mutable {
    std::vector<experiments::TrialResult> results;
    for (const experiments::TrialPlan& plan : plans) {
      if (count++ == dies_at) throw std::runtime_error("killed");
      results.push_back(drive_one(plan, kind, source));
    }
    return results;
  };
  driver.fits = [](const geometry::Pose2&) { return true; };
  driver.stopped = [stopped] { return stopped; };
  return driver;
}

experiments::DeploymentJob job() {
  experiments::DeploymentJob made;
  made.tasks = {"centre", "point"};
  made.rigs = {experiments::RigKind::kExplored, experiments::RigKind::kUnseen};
  made.sources.resize(2);
  made.sources[0].name = "planner";
  made.sources[1].name = "baseline";
  return made;
}

experiments::DeploymentConfig config() {
  experiments::DeploymentConfig made;
  made.trials.count = 3;
  return made;
}

runs::RunRequest request(const std::string& folder) {
  return {folder, "deploy", common::Json::object(), 1, /*resume=*/true};
}

/// Runs to the end; returns the results.
std::string deploy(const std::string& folder, experiments::TrialDriver driver) {
  const auto what = job();
  const auto how = config();
  runs::RunFolder run(request(folder));
  run.begin();
  experiments::DeploymentRun work(how, what, folder, std::move(driver));
  runs::run_resumably(run, work, {"deploy", "trials", 0.0});
  work.write_trials();
  return common::read_file(folder + "/summary.json") + common::read_file(folder + "/explored/trials.json") +
         common::read_file(folder + "/unseen/trials.json") +
         (std::filesystem::exists(folder + "/trajectories.csv")
              ? common::read_file(folder + "/trajectories.csv")
              : "");
}

}  // namespace

TEST_CASE("a killed deployment keeps the trials that have ended, and ends as an undisturbed one") {
  const tests::TemporaryFolder folder;
  const std::string whole = deploy(folder / "whole", fake_driver());
  for (const int dies_at : {0, 4, 23}) {
    CAPTURE(dies_at);
    const std::string path = folder / ("killed" + std::to_string(dies_at));
    CHECK_THROWS_WITH(deploy(path, fake_driver(dies_at)), "killed");
    if (dies_at > 0) {
      // What was written of a trial before the kill, without its end.
      std::ofstream(path + "/trajectories.csv", std::ios::app) << "explored,planner,centre,9,0.1\n";
      std::ofstream(path + "/trials.jsonl", std::ios::app) << "{\"task\": \"cent";
      CHECK(runs::find_run(path)->done == dies_at);
    }
    CHECK(deploy(path, fake_driver()) == whole);
  }
  SECTION("also where nothing but the trial itself was written") {
    const std::string path = folder / "first";
    CHECK_THROWS_WITH(deploy(path, fake_driver(1)), "killed");
    auto state = *runs::find_run(path);
    state.checkpoint.reset();
    state.done = 0;
    common::write_artefact(path + "/run.json", state);
    std::filesystem::remove(path + "/summary.json");
    experiments::TrialDriver driver = fake_driver();
    std::size_t driven = 0;
    driver.drive = [&driven, drive = driver.drive](const auto& plans, auto kind, const auto& source,
                                                   const auto& watch) {
      driven += plans.size();
      return drive(plans, kind, source, watch);
    };
    CHECK(deploy(path, std::move(driver)) == whole);
    CHECK(driven == 23);  // of 24: one had ended
  }
  const auto summary = common::read_artefact<runs::DeploymentSummary>(folder / "whole/summary.json");
  CHECK(summary.controller == "planner");
  CHECK(summary.tasks.by_task.at("centre").n_trials == 3);
  CHECK(summary.baseline->by_task.at("point").n_trials == 3);
  CHECK(summary.by_rig.at("unseen").tasks.by_task.size() == 2);
  const auto trials = runs::find_trials(folder / "whole/unseen");
  REQUIRE(trials->size() == 12);
  CHECK(trials->front().trajectory->size() == 2);
}

TEST_CASE("the map in which ways were searched is written beside the trials") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "run";
  experiments::DeploymentJob what = job();
  what.routes = std::make_shared<const task::RouteMap>(task::Region::disc(0.02, 0.004),
                                                       std::vector<task::Move>(), task::RouteConfig());
  const auto how = config();
  runs::RunFolder run(request(path));
  run.begin();
  experiments::DeploymentRun work(how, what, path, fake_driver());
  runs::run_resumably(run, work, {"deploy", "trials", 0.0});
  work.write_trials();
  const auto map = common::read_artefact<runs::ReachMap>(path + "/" + runs::ReachMap::kFile);
  CHECK(map.cell_mm == Approx(4.0));
  CHECK(map.reachable_mm.size() == what.routes->region().centres_m().size());
  const auto trials = runs::find_trials(path + "/explored");
  REQUIRE(trials);
  CHECK(trials->front().route_mm);
}

TEST_CASE("a rig that is stopped for good ends the run early, with what was driven and why") {
  const tests::TemporaryFolder folder;
  deploy(folder / "run", fake_driver(-1, "STOP exists"));
  const auto summary = common::read_artefact<runs::DeploymentSummary>(folder / "run/summary.json");
  CHECK(summary.stopped == "STOP exists");
  CHECK(summary.tasks.by_task.empty());
  CHECK(runs::find_trials(folder / "run/explored")->empty());
}

TEST_CASE("trials of another run in the journal are refused") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(deploy(folder / "run", fake_driver(2)), "killed");
  const auto how = config();
  auto what = job();
  what.sources[0].name = "policy";
  experiments::DeploymentRun work(how, what, folder / "run", fake_driver());
  CHECK_THROWS_AS(work.load(folder / "run"), common::DataError);
}

TEST_CASE("stitches are rehearsed once for a run, and aimed at alike after it was killed") {
  const tests::TemporaryFolder folder;
  experiments::DeploymentJob sewn;
  sewn.tasks = {"suture"};
  sewn.rigs = {experiments::RigKind::kExplored};
  sewn.sources = {tests::oblique()};
  int made = 0;
  sewn.sources[0].make = [&made](std::uint64_t) {
    ++made;
    return std::make_unique<tests::Oblique>();
  };
  const auto how = config();
  std::vector<experiments::TrialPlan> driven;
  const auto drive = [&](int dies_at) {
    experiments::TrialDriver driver = fake_driver(dies_at);
    driver.drive = [&driven, inner = driver.drive](const std::vector<experiments::TrialPlan>& plans,
                                                   auto kind, const auto& source, const auto& watch) {
      auto results = inner(plans, kind, source, watch);
      driven.insert(driven.end(), plans.begin(), plans.end());
      return results;
    };
    runs::RunFolder run(request(folder / "run"));
    run.begin();
    experiments::DeploymentRun work(how, sewn, folder / "run", std::move(driver));
    runs::run_resumably(run, work, {"deploy", "trials", 0.0});
  };
  CHECK_THROWS_WITH(drive(2), "killed");
  CHECK(made == 1);  // what is rehearsed by; the fake driver makes none
  drive(-1);
  CHECK(made == 2);
  REQUIRE(driven.size() == 3);
  for (const experiments::TrialPlan& plan : driven) {
    REQUIRE(plan.aims.size() == plan.stitches.size());
    CHECK(plan.aims[0].entry.x_m == driven[0].aims[0].entry.x_m);
    CHECK(plan.aims[0].entry.x_m - plan.stitches[0].entry.x_m == Approx(0.0003).margin(1e-6));
  }
}
