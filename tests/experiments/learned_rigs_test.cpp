#include "lodestone/experiments/learned_rigs.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// Two trials of a task on each rig, learned from little, by little networks.
experiments::DeployConfig two_on_each() {
  experiments::DeployConfig config;
  config.threads = 1;
  config.deployment.trials.count = 4;
  config.deployment.trials.per_rig = 2;
  config.deployment.trials.point_seconds = 1.0;
  config.deployment.sensor.kind = "simulated";
  config.deployment.rig.simulation.deviation = rig::DeviationWidth::kWide;
  return config;
}

experiments::TrialPlan plan_of(const experiments::DeployConfig& config, std::int64_t index) {
  return experiments::plan_trial(config.deployment, "point", index, {}, {},
                                 [](const geometry::Pose2&) { return true; });
}

}  // namespace

TEST_CASE("learners are told apart by their pulses and where they begin") {
  const experiments::RigLearner adapted{1000, false}, scratch{1000, true};
  CHECK(adapted.name() == "adapted_1000");
  CHECK(scratch.name() == "from_scratch_1000");
  experiments::DeployConfig config = two_on_each();
  config.dynamics = "here";
  const experiments::AdaptationConfig of = experiments::adaptation_of(adapted, config, 3);
  CHECK(of.dynamics == "here");
  CHECK(of.collection.transitions == 1000);
  CHECK(of.collection.rig.simulation.deviation == rig::DeviationWidth::kWide);
  CHECK(of.collection.seed != experiments::adaptation_of(adapted, config, 2).collection.seed);
  CHECK(of.collection.seed != experiments::adaptation_of({300, false}, config, 3).collection.seed);
  CHECK(experiments::adaptation_of(scratch, config, 3).dynamics.empty());
  CHECK_NOTHROW(of.validate());
}

TEST_CASE("a learner learns the rig that it drives, once, and others drive as they did", "[slow]") {
  const experiments::DeployConfig config = two_on_each();
  const tests::TemporaryFolder folder;
  const std::vector<experiments::RigLearner> learners = {{1000, true}};
  const auto driver = experiments::learning_driver(experiments::virtual_driver(config.deployment, 1, false),
                                                   learners, config, folder.path());
  CHECK(driver.batch % 2 == 0);
  experiments::ControllerSource learner;
  learner.name = learners[0].name();
  const std::vector<experiments::TrialPlan> plans = {plan_of(config, 2), plan_of(config, 3)};
  const auto results = driver.drive(plans, experiments::RigKind::kUnseen, learner, {});
  REQUIRE(results.size() == 2);
  CHECK(results[0].plan.index == 2);
  CHECK(results[0].controller == "from_scratch_1000");
  const runs::LearnedRigs learned = experiments::summarise_learned(learners[0], folder.path(), 2);
  CHECK(learned.rigs == 1);  // the other is not learned before it is driven
  CHECK(learned.kept == 1);
  CHECK(learned.rig_minutes == Approx(5.0));

  const auto again = driver.drive({plans[1]}, experiments::RigKind::kUnseen, learner, {});
  CHECK(again[0].samples.back().true_pose->x_m == results[1].samples.back().true_pose->x_m);

  const auto baseline = experiments::baseline_source(config.deployment);
  CHECK(driver.drive({plans[0]}, experiments::RigKind::kUnseen, baseline, {})[0].controller == "baseline");
}
