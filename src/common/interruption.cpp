#include "lodestone/common/interruption.h"

#include <chrono>

namespace lodestone::common {

void Interruption::raise() {
  const std::lock_guard<std::mutex> lock(mutex_);
  raised_ = true;
  changed_.notify_all();
}

void Interruption::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  raised_ = false;
}

bool Interruption::raised() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return raised_;
}

bool Interruption::wait_for(double time_s) {
  std::unique_lock<std::mutex> lock(mutex_);
  return !changed_.wait_for(lock, std::chrono::duration<double>(time_s), [this] { return raised_; });
}

}  // namespace lodestone::common
