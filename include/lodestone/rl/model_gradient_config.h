#pragma once

#include <cstdint>
#include <vector>

namespace lodestone::rl {

/// How a policy is led down the gradient of what the learned simulator expects of it.
struct ModelGradientConfig {
  std::vector<std::int64_t> hidden = {256, 256};
  double learning_rate = 1e-3;
  std::int64_t proposals = 4;
  double goal_radius_m = 0.0003;
  double current_cost_mm = 0.02;
  double gain_sigma = 0.45;
  double least_gain_sigma = 0.03;
  double place_sigma = 0.1;
  double place_size_m = 0.002;
  double new_goal = 0.1;
  double near_goals = 0.5;
  double most_target_step_m = 0.001;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("hidden", hidden, "", "width of each hidden layer of the policy", {1, 8192});
    v.field("learning_rate", learning_rate, "", "Adam's step size", {0.0, 1.0});
    v.field("proposals", proposals, "", "pulses that the policy proposes, of which it gives the best one",
            {1, 64});
    v.field("goal_radius_m", goal_radius_m, "m", "closer than this is no better", {0.0, 0.1});
    v.field("current_cost_mm", current_cost_mm, "mm", "cost of a pulse per squared action", {0.0, 1000.0});
    v.field("gain_sigma", gain_sigma, "",
            "standard deviation of the logarithm of the drive's gain over the rigs that are imagined",
            {0.0, 2.0});
    v.field(
        "least_gain_sigma", least_gain_sigma, "",
        "what is left of it once a rig is known: estimates lie between the two, spread by their logarithm",
        {0.0, 2.0});
    v.field("place_sigma", place_sigma, "",
            "the same of a place's own part: friction that stays the same until the needle is elsewhere",
            {0.0, 2.0});
    v.field("place_size_m", place_size_m, "m", "how far elsewhere is", {0.0, 1.0});
    v.field("new_goal", new_goal, "", "chance of a new goal at every pulse", {0.0, 1.0});
    v.field(
        "near_goals", near_goals, "",
        "share of the goals that lie near, at distances spread by their logarithm; the others all over the "
        "disc",
        {0.0, 1.0});
    v.field("most_target_step_m", most_target_step_m, "m/pulse",
            "half of the goals stand still, the others move by up to this", {0.0, 0.1});
  }
};

}  // namespace lodestone::rl
