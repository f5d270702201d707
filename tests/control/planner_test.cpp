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

TEST_CASE("in a world it knows, the planner is where a moving target is when that is there") {
  control::PlannerConfig config;
  config.goal_radius_m = 0.0;
  config.current_cost = 0.0;
  config.candidates = 400;
  config.iterations = 8;
  control::Planner planner(model(), config, 1);
  planner.reset();
  task::Observation observation;
  constexpr double kStep_m = 0.001;
  double x_m = 0.0;
  for (int step = 0; step < 10; ++step) {
    observation.target_m = {x_m, 0.01};
    observation.ahead.clear();
    for (int next = 1; next <= 5; ++next)
      observation.ahead.push_back({{x_m + next * kStep_m, 0.01}, 0.3 * next});
    const Vector2 action = planner.act(observation);
    observation.pose.x_m += 10.0 * kGain_m * action.x();
    observation.pose.y_m += 10.0 * kGain_m * action.y();
    x_m += kStep_m;
    if (step > 3) CHECK((observation.pose.position_m() - Vector2(x_m, 0.01)).norm() < 0.4e-3);
  }
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
