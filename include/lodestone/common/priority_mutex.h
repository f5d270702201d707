#pragma once

#include <pthread.h>

namespace lodestone::common {

/// A mutex between threads of which some go before others (RealtimeThread): while one of those waits, the
/// thread that holds it goes first, too, so that nothing in between keeps both waiting (priority
/// inheritance). Lockable as std::mutex is; conditions over it are std::condition_variable_any.
class PriorityMutex {
 public:
  PriorityMutex() {
    pthread_mutexattr_t how;
    pthread_mutexattr_init(&how);
    pthread_mutexattr_setprotocol(&how, PTHREAD_PRIO_INHERIT);
    pthread_mutex_init(&mutex_, &how);
    pthread_mutexattr_destroy(&how);
  }
  ~PriorityMutex() { pthread_mutex_destroy(&mutex_); }
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock() { pthread_mutex_lock(&mutex_); }
  bool try_lock() { return pthread_mutex_trylock(&mutex_) == 0; }
  void unlock() { pthread_mutex_unlock(&mutex_); }

 private:
  pthread_mutex_t mutex_;
};

}  // namespace lodestone::common
