#pragma once

#include "lodestone/physics/rig_description.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/task.h"

namespace lodestone::tests {

/// The rig that tests are about where it does not matter which.
inline physics::RigDescription paper_rig() { return {}; }

inline task::TaskConfig paper_task() {
  task::TaskConfig task;
  task.dish_radius_m = paper_rig().dish.radius_m;
  return task;
}

inline task::EncoderConfig paper_encoder() {
  task::EncoderConfig encoder;
  encoder.length_scale_m = paper_rig().dish.radius_m;
  return encoder;
}

inline task::ActionConfig paper_action() {
  task::ActionConfig action;
  action.scale = paper_rig().coils.max_current_A;
  return action;
}

}  // namespace lodestone::tests
