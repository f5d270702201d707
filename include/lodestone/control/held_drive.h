#pragma once

#include <mutex>

#include "lodestone/control/controller.h"
#include "lodestone/physics/coil_drive.h"

namespace lodestone::control {

/// Somebody at the controls: gives the drive that is held now.
class HeldDrive final : public Controller {
 public:
  /// `drive`: what the two numbers of a stick are for the rig (physics::CoilDrive::along).
  explicit HeldDrive(const physics::CoilDrive& drive = {}) : drive_(drive) {}
  /// From any thread; in [-1, 1]^2.
  void hold(const geometry::Vector2& direction) {
    const std::lock_guard<std::mutex> lock(mutex_);
    held_ = direction;
  }
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return drive_.along(held_, observation.pose.position_m());
  }

 private:
  physics::CoilDrive drive_;
  std::mutex mutex_;
  geometry::Vector2 held_ = geometry::Vector2::Zero();
};

}  // namespace lodestone::control
