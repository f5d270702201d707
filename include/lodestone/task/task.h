#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/task/region.h"

namespace lodestone::task {

/// The dish centre, points drawn uniformly over a disc, or points with a heading.
enum class GoalKind { kCentre, kPoint, kPose };
inline std::vector<std::string> names_of(GoalKind) { return {"centre", "point", "pose"}; }

/// Where starts and goals lie: all over their discs, or only where the data show them to be reachable.
enum class Within { kDisc, kReachable };
inline std::vector<std::string> names_of(Within) { return {"disc", "reachable"}; }

/// Goal, reward (eq. 3) and the rules that end an episode. Computed outside the dynamics network.
struct TaskConfig {
  GoalKind goal = GoalKind::kPoint;
  double goal_radius = 0.7;    ///< disc the point goals are drawn from, in dish radii
  double start_radius = 0.82;  ///< disc the starts are drawn from, in dish radii
  Within within = Within::kDisc;
  double alpha = -10.0;       ///< per dish radius of change of distance; the paper names no unit
  double beta = 10.0;         ///< bonus within the success radius
  double tau = -0.04;         ///< per step
  double current_cost = 0.0;  ///< per step and squared action: what holding still saves
  double success_radius_m = 0.003;
  double final_success_radius_m = 0.0;  ///< to which the radius shrinks while training; 0: it stays
  double heading_alpha = -5.0;          ///< per half turn of change of heading error (goal "pose")
  double success_heading_deg = 10.0;    ///< heading error that counts as reached (goal "pose")
  std::int64_t max_steps = 30;
  bool end_on_success = true;              ///< terminates within the success radius
  bool end_on_dish_exit = true;            ///< terminates outside the dish
  bool zero_current_moves_nothing = true;  ///< zero drive does not reach the network

  /// Leaving it ends the episode. No key: it is the rig's, or the reach of the data that were learned from.
  double dish_radius_m = 0.0;

  double goal_radius_m() const { return goal_radius * dish_radius_m; }
  double start_radius_m() const { return start_radius * dish_radius_m; }

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("goal", goal, "", "fixed centre, points drawn over a disc, or points with a heading");
    v.retired("goal_radius_m", "goal_radius, in dish radii");
    v.retired("start_radius_m", "start_radius, in dish radii");
    v.retired("dish_radius_m", "rig.dish.radius_m");
    v.field("goal_radius", goal_radius, "dish radii", "radius of the disc goals are drawn from", {0.0, 1.0});
    v.field("start_radius", start_radius, "dish radii", "radius of the disc starts are drawn from",
            {0.0, 1.0});
    v.field(
        "within", within, "",
        "the whole discs, or only the part of them that the dynamics' training data show to be reachable");
    v.field("alpha", alpha, "1/dish radius", "reward per change of distance to the goal (eq. 3)",
            {-1e4, 0.0});
    v.field("beta", beta, "", "bonus within the success radius (eq. 3)", {0.0, 1e4});
    v.field("tau", tau, "", "reward per step (eq. 3)", {-1e3, 0.0});
    v.field("current_cost", current_cost, "", "cost of a step per squared action, so that holding still pays",
            {0.0, 1e3});
    v.field("success_radius_m", success_radius_m, "m", "distance that counts as reached", {1e-5, 1.0});
    v.field("final_success_radius_m", final_success_radius_m, "m",
            "the radius shrinks linearly to this over the training; 0: it stays", {0.0, 1.0});
    v.field("heading_alpha", heading_alpha, "1/half turn", "reward per change of heading error, goal pose",
            {-1e4, 0.0});
    v.field("success_heading_deg", success_heading_deg, "deg",
            "heading error that counts as reached, goal pose", {0.1, 180.0});
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

/// Where to go, and how to lie there when the task is a pose.
struct Goal {
  geometry::Vector2 position_m = geometry::Vector2::Zero();
  std::optional<double> heading_rad;
};

/// Goal of a new episode, inside `region` when there is one.
Goal draw_goal(const TaskConfig& config, common::RandomStream& random, const Region* region = nullptr);

/// One step, as the rules see it.
struct Step {
  geometry::Pose2 before;
  geometry::Pose2 after;
  Goal goal;
  geometry::Drive action = geometry::Drive::Zero(2);  ///< in [-1, 1]^k
  std::int64_t index = 1;                             ///< within the episode, from 1
  double progress = 1.0;  ///< of the training, 0 to 1: how far the success radius has shrunk
};

/// The radius that counts as reached at this progress of the training.
double success_radius_m(const TaskConfig& config, double progress);

/// Whether this pose counts as the goal's at this progress: within the radius, and lying as the goal wants.
bool reached(const TaskConfig& config, const geometry::Pose2& pose, const Goal& goal, double progress);

/// Reward and end of one step. Eq. 3 with the distance in dish radii:
/// alpha * (d_after - d_before) / R + beta * [d_after < r] + tau; beyond the paper, the same for the heading
/// error in half turns (where the goal has one: both must be within their bounds), less current_cost *
/// |action|^2.
StepOutcome evaluate_step(const TaskConfig& config, const Step& step);

}  // namespace lodestone::task
