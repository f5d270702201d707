#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/rl/imagined_needle.h"

namespace lodestone::rl {

/// How a policy is led down the gradient of what the learned simulator expects of it.
struct ModelGradientConfig : ImaginationConfig {
  std::vector<std::int64_t> hidden = {256, 256};
  double learning_rate = 1e-3;
  std::int64_t proposals = 4;
  double goal_radius_m = 0.0003;
  double current_cost_mm = 0.02;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("hidden", hidden, "", "width of each hidden layer of the policy", {1, 8192});
    v.field("learning_rate", learning_rate, "", "Adam's step size", {0.0, 1.0});
    v.field("proposals", proposals, "", "pulses that the policy proposes, of which it gives the best one",
            {1, 64});
    v.field("goal_radius_m", goal_radius_m, "m", "closer than this is no better", {0.0, 0.1});
    v.field("current_cost_mm", current_cost_mm, "mm", "cost of a pulse per squared action", {0.0, 1000.0});
    ImaginationConfig::visit(v);  // of the goals half move
  }
};

}  // namespace lodestone::rl
