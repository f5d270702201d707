#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace lodestone::console {

/// A thread that does one thing after another, for whoever must not wait for a disk.
class Worker {
 public:
  Worker() : thread_([this] { run(); }) {}
  ~Worker() { end(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// `action` must not throw. Says no, and does nothing, where too much waits already or it has ended.
  bool ask(std::function<void()> action);
  /// Does first what was asked for.
  void end();

 private:
  static constexpr std::size_t kMost = 32;
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace lodestone::console
