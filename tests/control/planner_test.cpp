#include "lodestone/control/planner.h"

#include <catch2/catch.hpp>

#include "control/controller_conformance.h"
#include "env/linear_model.h"
#include "lodestone/common/error.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

constexpr double kGain_m = 0.8e-3;  // per unit of drive; the largest is 10

std::shared_ptr<const control::PlannerModel> model() {
  return std::make_shared<const control::PlannerModel>(
      env::tests::linear_model(data::StateLayout::kPose, {kGain_m, kGain_m}, {0.0, 0.0}));
}

}  // namespace

TEST_CASE("the planner keeps the promises of a controller") {
  control::Planner planner(model(), {}, 1);
  tests::check_controller(planner);
}

TEST_CASE("in a world it knows, the planner goes straight to the target and stays") {
  control::Planner planner(model(), {}, 1);
  planner.reset();
  task::Observation observation;
  observation.pose = {0.02, -0.01, 0.3};
  observation.target_m = {-0.004, 0.006};
  for (int step = 0; step < 12; ++step) {
    const Vector2 action = planner.act(observation);
    observation.pose.x_m += 10.0 * kGain_m * action.x();
    observation.pose.y_m += 10.0 * kGain_m * action.y();
  }
  CHECK((observation.pose.position_m() - observation.target_m).norm() < 0.0011);
  CHECK(planner.act(observation).isZero(0.0));  // nothing beats lying still
}

TEST_CASE("plans repeat after a reset, and bad settings are refused") {
  control::Planner planner(model(), {}, 1);
  task::Observation observation;
  observation.pose = {0.02, -0.01, 0.3};
  planner.reset();
  const Vector2 first = planner.act(observation);
  planner.act(observation);
  planner.reset();
  CHECK(planner.act(observation) == first);
  control::PlannerConfig config;
  config.elites = 1000;
  CHECK_THROWS_AS(control::Planner(model(), config, 1), common::ConfigError);
}
