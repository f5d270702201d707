#include "lodestone/task/task.h"

#include <cmath>

namespace lodestone::task {

geometry::Vector2 draw_in_disc(double radius_m, common::RandomStream& random) {
  const double radius = radius_m * std::sqrt(random.uniform());
  const double angle = random.uniform(-M_PI, M_PI);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

geometry::Vector2 draw_goal(const TaskConfig& config, common::RandomStream& random) {
  return config.goal == "centre" ? geometry::Vector2::Zero() : draw_in_disc(config.goal_radius_m, random);
}

StepOutcome judge_step(const TaskConfig& config, const geometry::Vector2& before_m,
                       const geometry::Vector2& after_m, const geometry::Vector2& goal_m, std::int64_t step) {
  const double distance_before = (before_m - goal_m).norm();
  const double distance_after = (after_m - goal_m).norm();
  StepOutcome outcome;
  outcome.success = distance_after < config.success_radius_m;
  outcome.reward = config.alpha * (distance_after - distance_before) / config.dish_radius_m +
                   (outcome.success ? config.beta : 0.0) + config.tau;
  outcome.terminated = (config.end_on_success && outcome.success) ||
                       (config.end_on_dish_exit && after_m.norm() > config.dish_radius_m);
  outcome.truncated = !outcome.terminated && step >= config.max_steps;
  return outcome;
}

}  // namespace lodestone::task
