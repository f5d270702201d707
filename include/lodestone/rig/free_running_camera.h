#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "lodestone/common/priority_mutex.h"
#include "lodestone/rig/camera.h"

namespace lodestone::rig {

/// Grabs images from a camera in a thread of its own, and keeps the newest. The control loop takes the next
/// one; who watches takes the last one at once, and neither ever waits for the other. Safe to use from any
/// thread.
class FreeRunningCamera final : public Camera {
 public:
  /// Gives up an image after `timeout_s`, and grabs at most one in `period_s`. The camera is used by nobody
  /// else.
  FreeRunningCamera(std::unique_ptr<Camera> camera, double timeout_s, double period_s = 0.0);
  ~FreeRunningCamera() override;

  /// The first image that arrives after the call. Throws HardwareError with what the camera says when there
  /// is none.
  imaging::Frame grab(double timeout_s) override;
  /// The newest image, which nobody changes any more; null before the first.
  std::shared_ptr<const imaging::Frame> latest() const;

 private:
  void run();

  std::unique_ptr<Camera> camera_;
  double timeout_s_;
  double period_s_;
  mutable common::PriorityMutex mutex_;  // of what follows; never held while an image is taken
  std::condition_variable_any arrived_;
  std::shared_ptr<const imaging::Frame> latest_;
  std::int64_t arrivals_ = 0;
  std::string fault_;  // what the last try said; empty when it gave an image
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace lodestone::rig
