#include "lodestone/task/task.h"

#include <catch2/catch.hpp>

#include "paper_rig.h"

using namespace lodestone::task;
using lodestone::geometry::Pose2;
using lodestone::geometry::Vector2;

namespace {

/// A step from one position to another towards the centre.
StepOutcome move(const TaskConfig& config, const Vector2& from_m, const Vector2& to_m, std::int64_t index) {
  Step step;
  step.before = {from_m.x(), from_m.y(), 0.0};
  step.after = {to_m.x(), to_m.y(), 0.0};
  step.index = index;
  return evaluate_step(config, step);
}

}  // namespace

TEST_CASE("equation 3 with the distance in dish radii") {
  const TaskConfig config = lodestone::tests::paper_task();
  const StepOutcome nearer = move(config, {0.0425, 0.0}, {0.02125, 0.0}, 1);
  CHECK(nearer.reward == Approx(5.0 - 0.04));
  CHECK_FALSE(nearer.terminated);
  CHECK_FALSE(nearer.truncated);
  const StepOutcome reached = move(config, {0.004, 0.0}, {0.002, 0.0}, 1);
  CHECK(reached.reward == Approx(10.0 * 0.002 / 0.0425 + 10.0 - 0.04));
  CHECK(reached.success);
  CHECK(reached.terminated);
}

TEST_CASE("termination and truncation are kept apart") {
  TaskConfig config = lodestone::tests::paper_task();
  config.max_steps = 5;
  CHECK(move(config, {0.01, 0.0}, {0.01, 0.0}, 5).truncated);
  const StepOutcome left = move(config, {0.04, 0.0}, {0.05, 0.0}, 5);
  CHECK(left.terminated);
  CHECK_FALSE(left.truncated);
  config.end_on_success = false;
  config.end_on_dish_exit = false;
  CHECK_FALSE(move(config, {0.04, 0.0}, {0.05, 0.0}, 1).terminated);
  CHECK_FALSE(move(config, {0.01, 0.0}, {0.001, 0.0}, 1).terminated);
}

TEST_CASE("goals fill their disc evenly") {
  TaskConfig config = lodestone::tests::paper_task();
  lodestone::common::RandomStream random(1, "goal");
  int inner = 0;
  for (int i = 0; i < 20000; ++i) {
    const double radius = draw_goal(config, random).position_m.norm();
    REQUIRE(radius <= config.goal_radius_m());
    if (radius < config.goal_radius_m() / 2.0) ++inner;
  }
  CHECK(inner / 20000.0 == Approx(0.25).margin(0.015));
  config.goal = GoalKind::kCentre;
  CHECK(draw_goal(config, random).position_m == Vector2::Zero());
}

TEST_CASE("the success radius shrinks with the training's progress") {
  TaskConfig config = lodestone::tests::paper_task();
  config.final_success_radius_m = 0.001;
  CHECK(success_radius_m(config, 0.0) == Approx(0.003));
  CHECK(success_radius_m(config, 0.5) == Approx(0.002));
  CHECK(success_radius_m(config, 7.0) == Approx(0.001));
  Step step;
  step.before = {0.01, 0.0, 0.0};
  step.after = {0.0015, 0.0, 0.0};
  CHECK_FALSE(evaluate_step(config, step).success);
  step.progress = 0.5;
  CHECK(evaluate_step(config, step).success);
  config.final_success_radius_m = 0.0;
  CHECK(success_radius_m(config, 1.0) == Approx(0.003));
}

TEST_CASE("a pose is reached when place and heading are") {
  TaskConfig config = lodestone::tests::paper_task();
  config.goal = GoalKind::kPose;
  Step step;
  step.before = {0.001, 0.0, 1.0};
  step.after = {0.001, 0.0, 3.1};
  step.goal.heading_rad = -3.1;
  const StepOutcome turned = evaluate_step(config, step);
  CHECK(turned.success);
  const double pi = 3.14159265358979;
  CHECK(turned.reward == Approx(-5.0 * ((2 * pi - 6.2) - (2 * pi - 4.1)) / pi + 10.0 - 0.04));
  step.after.heading_rad = 2.5;
  CHECK_FALSE(evaluate_step(config, step).success);
  CHECK(reached(config, {0.001, 0.0, 3.1}, step.goal, 1.0));
  CHECK_FALSE(reached(config, {0.001, 0.0, 2.5}, step.goal, 1.0));
  CHECK_FALSE(reached(config, {0.004, 0.0, 3.1}, step.goal, 1.0));
  config.final_success_radius_m = 0.0005;
  CHECK(reached(config, {0.001, 0.0, 3.1}, step.goal, 0.0));
  CHECK_FALSE(reached(config, {0.001, 0.0, 3.1}, step.goal, 1.0));
}

TEST_CASE("current costs what the configuration says") {
  TaskConfig config = lodestone::tests::paper_task();
  config.current_cost = 0.5;
  Step step;
  step.before = {0.02, 0.0, 0.0};
  step.after = step.before;
  step.action = {0.6, -0.8};
  CHECK(evaluate_step(config, step).reward == Approx(-0.04 - 0.5));
}
