#include "lodestone/control/planner.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "env/linear_model.h"
#include "lodestone/common/error.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

constexpr double kGain_m = 0.8e-3;  // per unit of drive; the largest is 10

std::shared_ptr<const control::LearnedSimulator> model() {
  return std::make_shared<const control::LearnedSimulator>(
      env::tests::linear_model(data::StateLayout::kPose, {kGain_m, kGain_m}, {0.0, 0.0}));
}

/// A cost-to-go that says: nowhere is better than anywhere else.
std::shared_ptr<const inference::CostToGo> flat_cost() {
  inference::PoseCost cost;
  cost.dish_radius_m = 0.0425;
  const inference::Arrays weights = {
      {"l1.weight",
       {std::vector<float>(static_cast<std::size_t>(inference::CostToGo::kFeatures)),
        {1, inference::CostToGo::kFeatures}}},
      {"l1.bias", {std::vector<float>{0.0F}, {1}}},
      {"l2.weight", {std::vector<float>{0.0F}, {1, 1}}},
      {"l2.bias", {std::vector<float>{0.3F}, {1}}}};
  return std::make_shared<const inference::CostToGo>(weights, std::vector<std::int64_t>{1}, cost);
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

TEST_CASE("a planner of four numbers finds the two that move the needle") {
  const auto of_four = std::make_shared<const control::LearnedSimulator>(
      env::tests::linear_model(data::StateLayout::kPose, {kGain_m}, {0.0}, 4));
  control::PlannerConfig config;
  config.candidates = 96;
  control::Planner planner(of_four, config, 1);
  planner.reset();
  task::Observation observation;
  observation.last_action = geometry::Drive::Zero(4);
  observation.pose = {0.012, -0.01, 0.3};
  observation.target_m = {-0.004, 0.006};
  for (int step = 0; step < 15; ++step) {
    const geometry::Drive action = planner.act(observation);
    REQUIRE(action.size() == 4);
    observation.pose.x_m += 10.0 * kGain_m * action[2];
    observation.pose.y_m += 10.0 * kGain_m * action[3];
  }
  CHECK((observation.pose.position_m() - observation.target_m).norm() < 0.0015);
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

TEST_CASE("the planner turns the needle to the heading that it shall have when a pulse is over") {
  const auto turning = std::make_shared<const control::LearnedSimulator>(
      env::tests::linear_model(data::StateLayout::kPose, {kGain_m}, {0.3}));  // with every pulse
  control::PlannerConfig config;
  config.candidates = 200;
  control::Planner planner(turning, config, 1);
  planner.reset();
  task::Observation observation;
  observation.target_heading_rad = 0.0;
  observation.ahead.push_back({{0.0, 0.0}, 0.3, 0.0});
  CHECK(planner.act(observation).isZero(0.0));
  observation.ahead[0].heading_rad = 0.3;
  CHECK_FALSE(planner.act(observation).isZero(0.0));
  observation.target_heading_rad.reset();
  observation.ahead[0].heading_rad.reset();
  CHECK(planner.act(observation).isZero(0.0));
}

TEST_CASE("along a path with headings the planner lets the needle be a little late, beside it never") {
  task::Observation observation;
  observation.target_m = {0.002, 0.0};
  observation.target_heading_rad = 0.0;
  observation.ahead.push_back({{0.0026, 0.0}, 0.3, 0.0});  // 0.6 mm a pulse along +x
  const auto pulse = [&](double slack_m, const geometry::Pose2& pose) -> geometry::Drive {
    control::PlannerConfig config;
    config.along_slack_m = slack_m;
    control::Planner planner(model(), config, 1);
    planner.reset();
    observation.pose = pose;
    return planner.act(observation);
  };
  CHECK(pulse(0.003, {0.0, 0.0, 0.0}).isZero(0.0));  // 2.6 mm late
  CHECK(pulse(0.0, {0.0, 0.0, 0.0}).x() > 0.05);
  const geometry::Drive beside = pulse(0.003, {0.0, 0.002, 0.0});
  CHECK(beside.y() < -0.05);
  CHECK(std::abs(beside.x()) < 0.5 * std::abs(beside.y()));
  observation.ahead.clear();  // it stays: to be there is what counts
  CHECK(pulse(0.003, {0.0, 0.0, 0.0}).x() > 0.05);
}

TEST_CASE("the planner goes by a cost-to-go to poses, and to points the distance does not lead to",
          "[unit]") {
  // One that says: the nearer to the goal's far side the better, whatever the distance. Its one unit takes
  // the third feature, the distance, and gives less where that is larger.
  std::vector<float> first(static_cast<std::size_t>(inference::CostToGo::kFeatures));
  first[2] = 1.0F;
  inference::PoseCost cost;
  cost.dish_radius_m = 0.0425;
  cost.current_cost = 0.0;
  const inference::Arrays weights = {{"l1.weight", {first, {1, inference::CostToGo::kFeatures}}},
                                     {"l1.bias", {std::vector<float>{0.0F}, {1}}},
                                     {"l2.weight", {std::vector<float>{-0.9F}, {1, 1}}},
                                     {"l2.bias", {std::vector<float>{0.9F}, {1}}}};
  const auto away = std::make_shared<const inference::CostToGo>(weights, std::vector<std::int64_t>{1}, cost);
  task::Observation observation;
  observation.pose = {0.01, 0.0, 0.3};
  control::PlannerConfig config;
  const auto distance_after_m = [&](const std::shared_ptr<const inference::CostToGo>& learned) {
    control::Planner planner(model(), config, 1, learned);
    planner.reset();
    const Vector2 action = planner.act(observation);
    return (observation.pose.position_m() + 10.0 * kGain_m * action).norm();
  };
  CHECK(distance_after_m(nullptr) < 0.006);
  CHECK(distance_after_m(away) < 0.006);  // no heading is asked for: the distance leads there
  config.goal_radius_m = 0.05;            // and here it does not
  CHECK(distance_after_m(nullptr) == 0.01);
  CHECK(distance_after_m(away) > 0.012);  // by a heading that it takes itself
  config.goal_radius_m = control::PlannerConfig{}.goal_radius_m;
  observation.target_heading_rad = 0.3;
  CHECK(distance_after_m(nullptr) < 0.006);
  CHECK(distance_after_m(away) > 0.012);
  observation.ahead.push_back({{0.0, 0.0}, 0.3, 0.3});  // one that moves is no pose to stay at
  CHECK(distance_after_m(away) < 0.006);
}

TEST_CASE("the planner leaves a hollow of the cost-to-go that pulses too weak to move the needle lie in",
          "[unit]") {
  // The weakest pulse costs least, and in a world with friction it moves nothing, again and again.
  control::Planner planner(model(), {}, 1, flat_cost());
  planner.reset();
  task::Observation observation;
  observation.pose = {0.01, 0.0, 0.3};
  observation.target_m = {-0.02, 0.0};
  observation.target_heading_rad = 0.3;
  constexpr double kHolds = 0.08;
  int pulses = 0;
  for (; pulses < 40; ++pulses) {
    const Vector2 action = planner.act(observation);
    CHECK_FALSE(action.isZero(0.0));  // it is never left lying so far away
    if (action.norm() > kHolds) break;
  }
  CHECK(pulses > 0);
  CHECK(pulses < 20);
}

TEST_CASE("a needle that is waited for is not left lying where it could rest", "[unit]") {
  task::Observation observation;
  observation.pose = {0.01, 0.0, 0.3};
  observation.target_m = {0.01, 0.0};
  observation.target_heading_rad = 0.3;
  const auto rests = [&] {
    control::Planner planner(model(), {}, 1, flat_cost());
    planner.reset();
    return planner.act(observation).isZero(0.0);
  };
  CHECK(rests());
  observation.awaited = true;
  CHECK_FALSE(rests());
}

TEST_CASE("the planner steers against a flow that it is told of, and rests where it is", "[unit]") {
  const Vector2 across_m(0.0, 3e-3);  // what a needle along x is carried by
  task::Observation observation;
  observation.pose = {0.01, 0.0, 0.0};
  const auto ends_m = [&](const Vector2& drift_m) {
    control::Planner planner(model(), {}, 1);
    planner.reset();
    observation.drift_m = {drift_m};
    const Vector2 action = planner.act(observation);
    CHECK(action.norm() > 0.5);
    return Vector2(observation.pose.position_m() + 10.0 * kGain_m * action + drift_m);
  };
  CHECK(ends_m({0.0, 0.0}).norm() < 0.004);
  CHECK((ends_m(across_m) - ends_m({0.0, 0.0})).norm() < 1.2e-3);
  observation.target_m = {0.01, 0.0};
  observation.drift_m = {across_m};
  control::Planner planner(model(), {}, 1);
  planner.reset();
  CHECK(planner.act(observation).isZero(0.0));
}

TEST_CASE("before it rests short of a point the planner tries what may bring the needle nearer", "[unit]") {
  const auto either_way = std::make_shared<const control::LearnedSimulator>(
      env::tests::linear_model(data::StateLayout::kPose, {kGain_m, -kGain_m}, {0.0, 0.0}));
  task::Observation observation;
  observation.pose = {0.002, 0.0, 0.0};
  const auto asked = [&] {
    control::Planner planner(either_way, {}, 1);
    planner.reset();
    return planner.act(observation);
  };
  CHECK_FALSE(asked().isZero(0.0));
  observation.ahead.push_back({observation.target_m, 0.3});  // one that moves has gone on by then
  CHECK(asked().isZero(0.0));
  observation.ahead.clear();
  observation.pose.x_m = 0.5 * control::PlannerConfig().goal_radius_m;
  CHECK(asked().isZero(0.0));
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

TEST_CASE("a planner that knows how strong its rig is lands where it wants to be", "[unit]") {
  const auto noisy =
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kGain_m));
  control::PlannerConfig config;
  config.horizon = 1;
  config.goal_radius_m = 0.0;
  config.current_cost = 0.0;
  task::Observation observation;
  observation.target_m = {0.004, -0.003};
  const auto off_m = [&](double gain) {
    control::Planner planner(noisy, config, 1);
    planner.reset();
    const Vector2 action = planner.act(observation);
    return (gain * 10.0 * kGain_m * action - observation.target_m).norm();
  };
  CHECK(off_m(1.0) < 0.3e-3);
  CHECK(off_m(2.0) > 4e-3);
  observation.drive_gain = task::DriveGain{std::log(2.0), 0.02};
  CHECK(off_m(2.0) < 0.3e-3);
}

TEST_CASE("a plan is for now: what was seen between does not matter to it", "[unit]") {
  control::PlannerConfig config;
  config.horizon = 1;
  control::Planner fresh(model(), config, 7);
  control::Planner used(model(), config, 7);
  task::Observation observation;
  observation.pose = {0.02, -0.01, 0.3};
  fresh.reset();
  used.reset();
  used.act(observation);
  observation.target_m = {0.015, -0.012};
  CHECK((used.act(observation) - fresh.act(observation)).norm() < 0.1);
}
