#include "lodestone/common/realtime.h"

#include <linux/capability.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <mutex>
#include <string>

#include "lodestone/common/log.h"

namespace lodestone::common {

namespace {

constexpr int kPriority = 10;  // before everything ordinary, behind the kernel's own threads

std::mutex g_lock_mutex;
int g_lockers = 0;  // memory is locked for the whole program, threads are many

bool may_lock_any_amount() {
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3] = {};
  return syscall(SYS_capget, &header, data) == 0 && (data[0].effective & 1U << CAP_IPC_LOCK) != 0;
}

/// Only without a limit: with one, the allocation that reached it would fail. Pages are locked as they are
/// first touched, so that the program does not grow.
bool lock_memory() {
  const std::lock_guard<std::mutex> lock(g_lock_mutex);
  if (g_lockers == 0 && (!may_lock_any_amount() || mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0))
    return false;
  ++g_lockers;
  return true;
}

void unlock_memory() {
  const std::lock_guard<std::mutex> lock(g_lock_mutex);
  if (--g_lockers == 0) munlockall();
}

void warn_once(bool goes_first, bool memory_locked) {
  static std::once_flag warned;
  std::call_once(warned, [&] {
    std::string missing = goes_first ? "" : "no real-time priority";
    if (!memory_locked) missing += std::string(missing.empty() ? "" : " and ") + "no locked memory";
    log_warning("this user gets " + missing +
                ": on a busy machine pulses come unevenly; add `@GROUP - rtprio 20` and `@GROUP - memlock "
                "unlimited` to /etc/security/limits.conf and log in again");
  });
}

}  // namespace

RealtimeThread::RealtimeThread() {
  sched_param before{};
  if (pthread_getschedparam(pthread_self(), &policy_before_, &before) == 0) {
    priority_before_ = before.sched_priority;
    sched_param wanted{};
    wanted.sched_priority = kPriority;
    goes_first_ = pthread_setschedparam(pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0;
  }
  memory_locked_ = lock_memory();
  if (!goes_first_ || !memory_locked_) warn_once(goes_first_, memory_locked_);
}

RealtimeThread::~RealtimeThread() {
  if (memory_locked_) unlock_memory();
  if (!goes_first_) return;
  sched_param before{};
  before.sched_priority = priority_before_;
  if (pthread_setschedparam(pthread_self(), policy_before_, &before) != 0)  // only root may drop the flag
    pthread_setschedparam(pthread_self(), policy_before_ | SCHED_RESET_ON_FORK, &before);
}

}  // namespace lodestone::common
