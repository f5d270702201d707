#include "lodestone/experiments/seeking.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

experiments::Collection seeking(const experiments::CollectionConfig& config) {
  experiments::SimulatorSource source;
  source.simulator =
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(0.5e-3));
  source.action = source.simulator->action;
  control::PlannerConfig planner;
  planner.candidates = 16;
  planner.iterations = 1;
  return experiments::Collection(config, experiments::make_exploration_session(config),
                                 experiments::goal_seeking(config, source, planner, {}, {}));
}

}  // namespace

TEST_CASE("a planner that seeks records pulses within its simulator's drives, and goes on bitwise") {
  experiments::CollectionConfig config;
  config.sensor.kind = "simulated";
  experiments::Collection whole = seeking(config);
  const data::Episode first = whole.next_episode(10);
  REQUIRE(first.length() >= 1);
  for (const double drive_A : first.actions) CHECK(std::abs(drive_A) <= 10.0);  // its simulator knows no more
  const common::Json state = common::Json::parse(whole.save().dump());
  experiments::Collection resumed = seeking(config);
  resumed.restore(state);
  for (int i = 0; i < 2; ++i) {
    const data::Episode next = whole.next_episode(10);
    const data::Episode again = resumed.next_episode(10);
    CHECK(next.observations == again.observations);
    CHECK(next.actions == again.actions);
  }
  common::Json broken = state;
  broken["teleoperator"] = "{}";
  CHECK_THROWS_AS(resumed.restore(broken), common::DataError);
}
