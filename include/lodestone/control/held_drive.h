#pragma once

#include <mutex>

#include "lodestone/control/controller.h"

namespace lodestone::control {

/// Somebody at the controls: gives the drive that is held now.
class HeldDrive final : public Controller {
 public:
  /// From any thread; in [-1, 1]^2.
  void hold(const geometry::Vector2& drive) {
    const std::lock_guard<std::mutex> lock(mutex_);
    drive_ = drive;
  }
  void reset() override {}
  geometry::Vector2 act(const task::Observation&) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return drive_;
  }

 private:
  std::mutex mutex_;
  geometry::Vector2 drive_ = geometry::Vector2::Zero();
};

}  // namespace lodestone::control
