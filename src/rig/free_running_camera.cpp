#include "lodestone/rig/free_running_camera.h"

#include <chrono>
#include <mutex>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/realtime.h"

namespace lodestone::rig {

namespace {
constexpr double kRetry_s = 0.05;  // after a camera that fails at once
}

FreeRunningCamera::FreeRunningCamera(std::unique_ptr<Camera> camera, double timeout_s, double period_s)
    : camera_(std::move(camera)), timeout_s_(timeout_s), period_s_(period_s), thread_([this] { run(); }) {}

FreeRunningCamera::~FreeRunningCamera() {
  ending_ = true;
  thread_.join();
}

void FreeRunningCamera::run() {
  const common::RealtimeThread realtime;  // an image that is late makes the pulse late
  common::SteadyClock clock;
  while (!ending_) {
    const double start_s = clock.now_s();
    std::shared_ptr<const imaging::Frame> frame;
    std::string fault;
    try {
      frame = std::make_shared<const imaging::Frame>(camera_->grab(timeout_s_));
    } catch (const std::exception& error) {
      fault = error.what();
    }
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex_);
      if (frame) {
        latest_ = frame;
        ++arrivals_;
      }
      fault_ = fault;
    }
    arrived_.notify_all();
    clock.sleep_until(start_s + (frame ? period_s_ : kRetry_s));
  }
}

imaging::Frame FreeRunningCamera::grab(double timeout_s) {
  std::unique_lock<common::PriorityMutex> lock(mutex_);
  const std::int64_t before = arrivals_;
  if (arrived_.wait_for(lock, std::chrono::duration<double>(timeout_s),
                        [&] { return arrivals_ != before; })) {
    const std::shared_ptr<const imaging::Frame> frame = latest_;
    lock.unlock();
    return {frame->image.clone(), frame->stamp_s};  // the loop may draw on it, others look at that one
  }
  throw common::HardwareError(fault_.empty() ? "camera: no image within " + std::to_string(timeout_s) + " s"
                                             : fault_);
}

std::shared_ptr<const imaging::Frame> FreeRunningCamera::latest() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  return latest_;
}

}  // namespace lodestone::rig
