#pragma once

#include <memory>

#include "lodestone/task/observation.h"

namespace lodestone::control {

/// Decides one pulse. A TD3 policy, a planner and a classical controller are the same thing to the control
/// loop.
class Controller {
 public:
  virtual ~Controller() = default;
  /// Forgets the episode before (memory, adaptive gains).
  virtual void reset() = 0;
  /// Action in [-1, 1]^k, of as many numbers as the rig's drive has.
  virtual geometry::Drive act(const task::Observation& observation) = 0;
  /// One that knows what this one knows, to be asked what it would do without this one's taking note. Nothing
  /// from those that only act on what is seen for sure.
  virtual std::unique_ptr<Controller> clone() const { return nullptr; }
};

}  // namespace lodestone::control
