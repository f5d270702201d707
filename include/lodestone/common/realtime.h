#pragma once

namespace lodestone::common {

/// While it lives, the thread that made it goes before all ordinary ones, and the memory of the program is
/// not paged out, each where the system allows it. Where it does not, one warning per program says what to
/// do. Its end puts back what was before; it has to come in the same thread. Threads and programs that are
/// started meanwhile are ordinary ones.
class RealtimeThread {
 public:
  RealtimeThread();
  ~RealtimeThread();
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

  bool goes_first() const { return goes_first_; }
  bool memory_locked() const { return memory_locked_; }

 private:
  bool goes_first_ = false;
  bool memory_locked_ = false;
  int policy_before_ = 0;
  int priority_before_ = 0;
};

}  // namespace lodestone::common
