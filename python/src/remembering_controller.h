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
  explicit RememberingController(std::unique_ptr<control::Controller> controller)
      : controller_(std::move(controller)) {
    controller_->reset();
  }
  /// Forgets the episode before.
  void reset();
  /// Action in [-1, 1]^2, as the control loop asks for it.
  geometry::Vector2 act(const geometry::Pose2& pose, const geometry::Vector2& target_m,
                        std::optional<double> target_heading_rad);

 private:
  std::mutex mutex_;
  std::unique_ptr<control::Controller> controller_;
  std::optional<geometry::Vector2> position_m_;
  geometry::Vector2 action_ = geometry::Vector2::Zero();
};

}  // namespace lodestone::python
