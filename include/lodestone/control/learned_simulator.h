#pragma once

#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/task/action.h"

namespace lodestone::control {

/// A learned simulator ready for deciding: shared by controllers, read only.
struct LearnedSimulator {
  explicit LearnedSimulator(const inference::DynamicsModel& model)
      : members(model.members),
        state_size(static_cast<std::size_t>(data::state_size(model.info.layout))),
        sampled(model.config.components > 0),
        dish_radius_m(model.info.workspace_radius_m),
        recorded_moves(model.recorded_moves) {
    LODESTONE_CHECK(!members.empty(), "the ensemble has no member");
    action.scale = model.info.action_scale;
    action.unit = model.info.action_unit;
    action.one_axis_at_a_time = model.info.one_axis_at_a_time;
    action.size = model.info.action_size;
  }

  std::vector<inference::FoldedDynamics> members;
  std::size_t state_size;
  bool sampled;  ///< a distribution is predicted, so outcomes are drawn from it
  double dish_radius_m;
  std::vector<task::Move> recorded_moves;  ///< that it was trained on
  task::ActionConfig action;               ///< in the simulator's unit of drive
};

}  // namespace lodestone::control
