#pragma once

#include <cstdint>
#include <memory>

#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/region.h"
#include "lodestone/task/task.h"

namespace lodestone::rl {

/// What a learner learns for that steps needles of its own in the learned simulator.
struct ImaginedTask {
  task::TaskConfig task;
  task::EncoderConfig encoder;
  task::ActionConfig action;
  double pose_noise_m = 0.0;  ///< of what the policy sees
  double heading_noise_rad = 0.0;
  std::int64_t environments = 1024;
  std::shared_ptr<const task::Region> region;  ///< that starts and goals lie in; null: the whole discs
};

}  // namespace lodestone::rl
