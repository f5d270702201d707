#pragma once

#include <condition_variable>
#include <mutex>

namespace lodestone::common {

/// Ends waits, from any thread: a wait that has begun, and every later one until clear().
class Interruption {
 public:
  void raise();
  void clear();
  bool raised() const;
  /// Waits on the wall clock; false as soon as it is raised.
  bool wait_for(double time_s);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool raised_ = false;
};

}  // namespace lodestone::common
