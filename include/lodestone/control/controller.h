#pragma once

#include "lodestone/task/observation.h"

namespace lodestone::control {

/// Decides one pulse. A TD3 policy, a planner and a classical controller are the same thing to the control
/// loop.
class Controller {
 public:
  virtual ~Controller() = default;
  /// Forgets the episode before (memory, adaptive gains).
  virtual void reset() = 0;
  /// Action in [-1, 1]^2.
  virtual geometry::Vector2 act(const task::Observation& observation) = 0;
};

}  // namespace lodestone::control
