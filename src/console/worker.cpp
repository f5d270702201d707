#include "lodestone/console/worker.h"

#include <utility>

#include "lodestone/common/thread_name.h"

namespace lodestone::console {

void Worker::end() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool Worker::ask(std::function<void()> action) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (over_ || waiting_.size() >= kMost) return false;
  waiting_.push_back(std::move(action));
  changed_.notify_all();
  return true;
}

void Worker::run() {
  common::name_thread("clerk");
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return over_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::function<void()> action = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    action();
    lock.lock();
  }
}

}  // namespace lodestone::console
