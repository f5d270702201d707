#include "lodestone/task/task.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::task {
namespace {

/// In half turns.
double heading_error(const geometry::Pose2& pose, double heading_rad) {
  return std::abs(geometry::wrap_angle(pose.heading_rad - heading_rad)) / geometry::kPi;
}

}  // namespace

geometry::Vector2 draw_in_disc(double radius_m, common::RandomStream& random) {
  const double radius = radius_m * std::sqrt(random.uniform());
  const double angle = random.uniform(-geometry::kPi, geometry::kPi);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

Goal draw_goal(const TaskConfig& config, common::RandomStream& random, const Region* region) {
  Goal goal;
  if (config.goal == GoalKind::kCentre) return goal;
  const auto draw = [&] { return draw_in_disc(config.goal_radius_m(), random); };
  goal.position_m = region != nullptr ? region->draw(draw) : draw();
  if (config.goal == GoalKind::kPose) goal.heading_rad = random.uniform(-geometry::kPi, geometry::kPi);
  return goal;
}

double success_radius_m(const TaskConfig& config, double progress) {
  if (config.final_success_radius_m <= 0.0) return config.success_radius_m;
  return config.success_radius_m +
         std::min(1.0, progress) * (config.final_success_radius_m - config.success_radius_m);
}

bool reached(const TaskConfig& config, const geometry::Pose2& pose, const Goal& goal, double progress) {
  if ((pose.position_m() - goal.position_m).norm() >= success_radius_m(config, progress)) return false;
  return !goal.heading_rad || 180.0 * heading_error(pose, *goal.heading_rad) < config.success_heading_deg;
}

StepOutcome evaluate_step(const TaskConfig& config, const Step& step) {
  const double distance_before = (step.before.position_m() - step.goal.position_m).norm();
  const double distance_after = (step.after.position_m() - step.goal.position_m).norm();
  StepOutcome outcome;
  outcome.success = reached(config, step.after, step.goal, step.progress);
  outcome.reward = config.alpha * (distance_after - distance_before) / config.dish_radius_m + config.tau -
                   config.current_cost * step.action.squaredNorm();
  if (const std::optional<double> heading_rad = step.goal.heading_rad)
    outcome.reward += config.heading_alpha *
                      (heading_error(step.after, *heading_rad) - heading_error(step.before, *heading_rad));
  if (outcome.success) outcome.reward += config.beta;
  outcome.terminated = (config.end_on_success && outcome.success) ||
                       (config.end_on_dish_exit && step.after.position_m().norm() > config.dish_radius_m);
  outcome.truncated = !outcome.terminated && step.index >= config.max_steps;
  return outcome;
}

}  // namespace lodestone::task
