#include "lodestone/experiments/rigs_bench.h"

#include <catch2/catch.hpp>
#include <set>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// The planner errs by as many mm as its rig's number, the baseline by one more; headings by ten degrees
/// more.
experiments::TrialDriver numbered_driver(std::int64_t per_rig) {
  experiments::TrialDriver driver;
  driver.drive = [per_rig](const std::vector<experiments::TrialPlan>& plans, experiments::RigKind kind,
                           const experiments::ControllerSource& source, const experiments::TrialWatch&) {
    std::vector<experiments::TrialResult> results;
    for (const experiments::TrialPlan& plan : plans) {
      experiments::TrialResult result;
      result.plan = plan;
      result.rig = experiments::to_string(kind);
      result.controller = source.name;
      result.samples.emplace_back().true_pose = plan.start;
      result.truth.emplace().final_error_mm =
          static_cast<double>(plan.index / per_rig) + (source.name == "baseline" ? 1.0 : 0.0);
      result.truth->success = result.truth->final_error_mm < 1.5;
      result.truth->heading_rms_deg = 10.0 + result.truth->final_error_mm;
      result.sensed = *result.truth;
      result.completed = true;
      results.push_back(result);
    }
    return results;
  };
  driver.fits = [](const geometry::Pose2&) { return true; };
  driver.stopped = [] { return std::string(); };
  return driver;
}

experiments::RigsBenchConfig four_rigs() {
  experiments::RigsBenchConfig bench;
  bench.rigs = 4;
  bench.deployment.trials.count = 3;
  bench.deployment.rig.simulation.deviation = rig::DeviationWidth::kWide;
  return bench;
}

}  // namespace

TEST_CASE("rigs are summed up by controller and task, and the baseline is what is compared with") {
  const experiments::RigsBenchConfig bench = four_rigs();
  const experiments::DeployConfig config = bench.deploy();
  CHECK(config.deployment.trials.count == 12);
  experiments::DeploymentJob job;
  job.tasks = {"point"};
  job.rigs = {experiments::RigKind::kUnseen};
  job.sources.resize(2);
  job.sources[0].name = "planner";
  job.sources[1].name = "baseline";
  const tests::TemporaryFolder folder;
  experiments::RigsRun run(bench, config, job, folder.path(), numbered_driver(3));
  common::MetricsLog metrics(folder.path());
  while (!run.progress().finished) run.step(metrics);
  run.save(folder.path());

  auto summary = common::read_artefact<runs::RigsSummary>(folder / runs::RigsSummary::kFile);
  const runs::RigsTaskSummary& planner = summary.by_controller["planner"]["point"];
  CHECK(summary.rigs == 4);
  CHECK(planner.n_trials == 12);
  CHECK(planner.truth->mean_error_mm == Approx(1.5));
  CHECK(planner.truth->success_rate == Approx(0.5));
  CHECK(planner.mean_error_interval_mm[0] < 1.0);  // four rigs, which differ
  CHECK(planner.mean_error_interval_mm[1] > 2.0);
  REQUIRE(planner.heading_rms_interval_deg);
  CHECK(*planner.truth->heading_rms_deg == Approx(11.5));
  CHECK(planner.heading_rms_interval_deg->at(0) < 11.0);
  CHECK(planner.heading_rms_interval_deg->at(1) > 12.0);
  CHECK(planner.worst.rig == 3);
  CHECK(planner.worst.mean_error_mm == Approx(3.0));
  REQUIRE(planner.minus_baseline_mm);
  CHECK(*planner.minus_baseline_mm == Approx(-1.0));
  CHECK(planner.minus_baseline_interval_mm->at(1) == Approx(-1.0));  // the same trials: no rig says otherwise
  CHECK_FALSE(summary.by_controller["baseline"]["point"].minus_baseline_mm);

  const auto rigs = common::read_artefact<runs::RigsResult>(folder / runs::RigsResult::kFile);
  REQUIRE(rigs.rigs.size() == 4);
  std::set<double> moments;
  for (const runs::RigFigures& rig : rigs.rigs) moments.insert(rig.moment);
  CHECK(moments.size() == 4);
  CHECK(rigs.rigs[2].mean_error_mm.at("baseline").at("point") == Approx(3.0));
}

TEST_CASE("all controllers and tasks have the same rigs, as many trials on each as asked for") {
  const experiments::DeploymentConfig config = four_rigs().deploy().deployment;
  const auto seed = [&](const char* task, std::int64_t trial) {
    return experiments::unseen_rig(config, task, trial).seed;
  };
  CHECK(seed("point", 0) == seed("square", 2));
  CHECK(seed("point", 2) != seed("point", 3));
  experiments::RigsBenchConfig once = four_rigs();
  once.deployment.trials.count = 1;
  const experiments::DeploymentConfig one_each = once.deploy().deployment;
  CHECK(experiments::unseen_rig(one_each, "point", 2).seed ==
        experiments::unseen_rig(one_each, "circle", 2).seed);
  experiments::DeploymentConfig alone = config;
  alone.trials.per_rig = 0;
  CHECK(experiments::unseen_rig(alone, "point", 0).seed != experiments::unseen_rig(alone, "square", 0).seed);
}

TEST_CASE("the bench finds its models in one folder, and what goes around controllers beside the policy") {
  experiments::RigsBenchConfig bench = four_rigs();
  bench.models = std::string(LODESTONE_SOURCE_DIR) + "/models";
  CHECK(bench.deploy().policy == bench.models + "/any_rig");
  CHECK(bench.deploy().dynamics == bench.models + "/dynamics_best");
  CHECK(bench.deploy().deployment.decorators.stall_gain == 1.0);
  bench.decorated = true;
  CHECK(bench.deploy().deployment.decorators.stall_gain > 1.0);
  bench.models = "";
  CHECK_THROWS_WITH(bench.deploy(), Catch::Contains("name a policy"));
  bench.controllers = "planner,policy";
  CHECK(bench.controller_names() == std::vector<std::string>{"planner", "policy"});
  bench.controllers = "planner,planner";
  CHECK_THROWS_WITH(bench.controller_names(), Catch::Contains("comes twice"));
  bench.controllers = "planner,magic";
  CHECK_THROWS_WITH(bench.controller_names(), Catch::Contains("\"magic\" is none of"));
  bench.controllers = "";
  CHECK_THROWS_AS(bench.controller_names(), common::ConfigError);
}

TEST_CASE("planners that learned their rigs are compared with the one that only identifies them", "[slow]") {
  experiments::RigsBenchConfig bench = four_rigs();
  bench.threads = 1;
  bench.rigs = 1;
  bench.deployment.trials.count = 2;
  bench.deployment.trials.point_seconds = 1.0;
  bench.deployment.sensor.kind = "simulated";
  bench.task = "point";
  bench.controllers = "baseline";
  bench.from_scratch = {1000};
  const experiments::DeployConfig config = bench.deploy();
  experiments::DeploymentJob job = experiments::plan_rigs(bench, config);
  REQUIRE(job.sources.size() == 2);
  job.sources[0].name = "planner";  // whoever drives, it is the name that counts
  const tests::TemporaryFolder folder;
  experiments::RigsRun run(bench, config, job, folder.path(),
                           experiments::virtual_driver(config.deployment, 1, false));
  common::MetricsLog metrics(folder.path());
  while (!run.progress().finished) run.step(metrics);

  runs::RigsSummary summary = run.rigs_summary();
  CHECK(summary.learned.at("from_scratch_1000").rigs == 1);
  CHECK(summary.learned.at("from_scratch_1000").rig_minutes == Approx(5.0));
  const runs::RigsTaskSummary& planner = summary.by_controller["planner"]["point"];
  const runs::RigsTaskSummary& learned = summary.by_controller["from_scratch_1000"]["point"];
  CHECK(learned.n_trials == 2);
  CHECK_FALSE(planner.minus_planner_mm);
  REQUIRE(learned.minus_planner_mm);
  CHECK(*learned.minus_planner_mm == Approx(learned.truth->mean_error_mm - planner.truth->mean_error_mm));
}

TEST_CASE("what a bench of rigs cannot learn is refused before anything is driven") {
  experiments::RigsBenchConfig bench = four_rigs();
  bench.adapt = {1000};
  CHECK_THROWS_WITH(bench.validate(), Catch::Contains("--models DIR"));
  bench.models = "models";
  CHECK_NOTHROW(bench.validate());
  bench.adapt = {1000, 1000};
  CHECK_THROWS_WITH(bench.validate(), Catch::Contains("adapt: 1000 pulses come twice"));
  bench.adapt = {};
  bench.from_scratch = {1000};
  CHECK_NOTHROW(bench.validate());
  bench.controllers = "";
  CHECK(bench.controller_names().empty());
  bench.from_scratch = {30};
  CHECK_THROWS_WITH(bench.validate(), Catch::Contains("8 episodes"));
}

TEST_CASE("what a bench of rigs cannot do is refused") {
  experiments::RigsBenchConfig bench = four_rigs();
  CHECK_NOTHROW(bench.validate());
  bench.deployment.record.enabled = true;
  CHECK_THROWS_WITH(bench.validate(), Catch::Contains("record.enabled"));
  bench = four_rigs();
  bench.deployment.trials.per_rig = 2;
  CHECK_THROWS_WITH(bench.validate(), Catch::Contains("trials.per_rig = 2"));
  bench = four_rigs();
  bench.deployment.rig.backend = rig::Backend::kSerial;
  CHECK_THROWS_AS(bench.validate(), common::ConfigError);
}
