#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "lodestone/control/controller.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::python {

/// A controller that is asked from outside, pose by pose, and remembers between two what the control loop
/// would: the last action and the sensed motion since. Any thread may ask; one waits for the other.
class RememberingController {
 public:
  /// `action_size`: numbers of its actions.
  RememberingController(std::unique_ptr<control::Controller> controller, int action_size)
      : controller_(std::move(controller)), action_(geometry::Drive::Zero(action_size)) {
    controller_->reset();
  }
  /// Forgets the episode before.
  void reset();
  /// Action in [-1, 1]^k, as the control loop asks for it.
  geometry::Drive act(const geometry::Pose2& pose, const geometry::Vector2& target_m,
                      std::optional<double> target_heading_rad);

 private:
  std::mutex mutex_;
  std::unique_ptr<control::Controller> controller_;
  std::optional<geometry::Vector2> position_m_;
  geometry::Drive action_;
};

}  // namespace lodestone::python
