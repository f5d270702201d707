#include "lodestone/task/task.h"

#include <catch2/catch.hpp>

using namespace lodestone::task;
using lodestone::geometry::Vector2;

TEST_CASE("equation 3 with the distance in dish radii") {
  const TaskConfig config;
  const StepOutcome nearer = judge_step(config, {0.0425, 0.0}, {0.02125, 0.0}, Vector2::Zero(), 1);
  CHECK(nearer.reward == Approx(5.0 - 0.04));
  CHECK_FALSE(nearer.terminated);
  CHECK_FALSE(nearer.truncated);
  const StepOutcome reached = judge_step(config, {0.004, 0.0}, {0.002, 0.0}, Vector2::Zero(), 1);
  CHECK(reached.reward == Approx(10.0 * 0.002 / 0.0425 + 10.0 - 0.04));
  CHECK(reached.success);
  CHECK(reached.terminated);
}

TEST_CASE("termination and truncation are kept apart") {
  TaskConfig config;
  config.max_steps = 5;
  CHECK(judge_step(config, {0.01, 0.0}, {0.01, 0.0}, Vector2::Zero(), 5).truncated);
  const StepOutcome left = judge_step(config, {0.04, 0.0}, {0.05, 0.0}, Vector2::Zero(), 5);
  CHECK(left.terminated);
  CHECK_FALSE(left.truncated);
  config.end_on_success = false;
  config.end_on_dish_exit = false;
  CHECK_FALSE(judge_step(config, {0.04, 0.0}, {0.05, 0.0}, Vector2::Zero(), 1).terminated);
  CHECK_FALSE(judge_step(config, {0.01, 0.0}, {0.001, 0.0}, Vector2::Zero(), 1).terminated);
}

TEST_CASE("goals fill their disc evenly") {
  TaskConfig config;
  lodestone::common::RandomStream random(1, "goal");
  int inner = 0;
  for (int i = 0; i < 20000; ++i) {
    const double radius = draw_goal(config, random).norm();
    REQUIRE(radius <= config.goal_radius_m);
    if (radius < config.goal_radius_m / 2.0) ++inner;
  }
  CHECK(inner / 20000.0 == Approx(0.25).margin(0.015));
  config.goal = "centre";
  CHECK(draw_goal(config, random) == Vector2::Zero());
}
