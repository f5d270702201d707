#include "lodestone/experiments/oracle.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

experiments::DeploymentConfig short_trials() {
  experiments::DeploymentConfig config;
  config.sensor.kind = "simulated";
  config.trials.point_seconds = 5.0;
  config.planner.candidates = 24;
  config.planner.particles = 2;
  return config;
}

std::vector<experiments::TrialResult> driven(const experiments::DeploymentConfig& config,
                                             const experiments::ControllerSource& source,
                                             std::size_t threads = 2) {
  const experiments::Deployment deployment(config);
  std::vector<experiments::TrialPlan> plans;
  for (int i = 0; i < 3; ++i)
    plans.push_back(
        experiments::plan_trial(config, "point", i, std::nullopt, std::nullopt,
                                [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
  common::ThreadPool pool(threads);
  return deployment.run(plans, experiments::RigKind::kUnseen, source, pool);
}

}  // namespace

TEST_CASE("the oracle goes by the rig that there is, not by the one described or seen") {
  experiments::DeploymentConfig config = short_trials();
  config.rig.simulation.deviation = rig::DeviationWidth::kWide;
  config.sensor.simulated.calibration_offset_m = 5e-3;
  const experiments::ControllerSource oracle = experiments::oracle_source(config);
  CHECK(oracle.name == "oracle");
  const auto results = driven(config, oracle);
  for (const experiments::TrialResult& result : results) {
    CAPTURE(result.plan.index);
    CHECK(result.truth->final_error_mm < 1.0);
  }
  const auto again = driven(config, oracle, 1);
  for (std::size_t i = 0; i < results.size(); ++i)
    CHECK(again[i].truth->final_error_mm == results[i].truth->final_error_mm);
}

TEST_CASE("nothing but the virtual rig of a trial can be driven by the oracle, and no sphere") {
  experiments::DeploymentConfig config = short_trials();
  const auto bench = session::make_virtual_session(config.rig, config.sensor, {}, {});
  const auto plan = experiments::plan_trial(config, "point", 0, std::nullopt, std::nullopt,
                                            [&](const geometry::Pose2& pose) { return bench->fits(pose); });
  CHECK_THROWS_AS(experiments::run_on_session(*bench, config, plan, experiments::oracle_source(config)),
                  common::LogicFault);
  config.rig.needle = tests::sphere();
  CHECK_THROWS_WITH(experiments::oracle_source(config), Catch::Contains("rig.needle.shape"));
}
