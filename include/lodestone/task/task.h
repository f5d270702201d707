#pragma once

#include <cstdint>
#include <string>

#include "lodestone/common/random.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::task {

/// Goal, reward (eq. 3) and the rules that end an episode. Computed outside the dynamics network.
struct TaskConfig {
  std::string goal = "point";     ///< "centre" or "point" (drawn uniformly over a disc)
  double goal_radius_m = 0.030;   ///< disc the point goals are drawn from
  double start_radius_m = 0.035;  ///< disc the starts are drawn from
  double dish_radius_m = 0.0425;
  double alpha = -10.0;  ///< per dish radius of change of distance (paper-notes: the unit that fits -5..10)
  double beta = 10.0;    ///< bonus within the success radius
  double tau = -0.04;    ///< per step
  double success_radius_m = 0.003;
  std::int64_t max_steps = 30;
  bool end_on_success = true;              ///< terminates within the success radius
  bool end_on_dish_exit = true;            ///< terminates outside the dish
  bool zero_current_moves_nothing = true;  ///< zero drive does not reach the network

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("goal", goal, "", "fixed centre, or points drawn over a disc", {"centre", "point"});
    v.field("goal_radius_m", goal_radius_m, "m", "radius of the disc goals are drawn from", {0.0, 1.0});
    v.field("start_radius_m", start_radius_m, "m", "radius of the disc starts are drawn from", {0.0, 1.0});
    v.field("dish_radius_m", dish_radius_m, "m", "leaving this radius ends the episode", {1e-3, 1.0});
    v.field("alpha", alpha, "1/dish radius", "reward per change of distance to the goal (eq. 3)",
            {-1e4, 0.0});
    v.field("beta", beta, "", "bonus within the success radius (eq. 3)", {0.0, 1e4});
    v.field("tau", tau, "", "reward per step (eq. 3)", {-1e3, 0.0});
    v.field("success_radius_m", success_radius_m, "m", "distance that counts as reached", {1e-5, 1.0});
    v.field("max_steps", max_steps, "steps", "step limit; truncates", {1, 100000});
    v.field("end_on_success", end_on_success, "", "reaching the goal terminates the episode");
    v.field("end_on_dish_exit", end_on_dish_exit, "", "leaving the dish terminates the episode");
    v.field("zero_current_moves_nothing", zero_current_moves_nothing, "",
            "zero drive keeps the state and does not reach the network");
  }
};

struct StepOutcome {
  double reward = 0.0;
  bool terminated = false;  ///< reached, or left the dish
  bool truncated = false;   ///< step limit
  bool success = false;
};

/// Point drawn uniformly over a disc.
geometry::Vector2 draw_in_disc(double radius_m, common::RandomStream& random);

/// Goal of a new episode.
geometry::Vector2 draw_goal(const TaskConfig& config, common::RandomStream& random);

/// Reward and end of one step from `before_m` to `after_m`; `step` counts from 1.
/// Eq. 3 with the distance in dish radii: alpha * (d_after - d_before) / R + beta * [d_after < r] + tau.
StepOutcome judge_step(const TaskConfig& config, const geometry::Vector2& before_m,
                       const geometry::Vector2& after_m, const geometry::Vector2& goal_m, std::int64_t step);

}  // namespace lodestone::task
