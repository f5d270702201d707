#include "lodestone/common/realtime.h"

#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "temporary_folder.h"

using namespace lodestone;

namespace {

int policy() { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }  // of this thread

long locked_kb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "VmLck:") {
      long kb = 0;
      status >> kb;
      return kb;
    }
  return -1;
}

/// Sanitizers make mlockall() do nothing, and say that it did.
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr bool kLocks = false;
#else
constexpr bool kLocks = true;
#endif

}  // namespace

TEST_CASE("a real-time thread goes first where it may, alone, and only while it lasts") {
  REQUIRE(policy() == SCHED_OTHER);
  {
    const common::RealtimeThread realtime;
    CHECK(policy() == (realtime.goes_first() ? SCHED_FIFO : SCHED_OTHER));
    CHECK((locked_kb() > 0) == (kLocks && realtime.memory_locked()));
    int of_child = -1;
    std::thread([&] { of_child = policy(); }).join();
    CHECK(of_child == SCHED_OTHER);
    {
      const common::RealtimeThread again;
      CHECK(again.memory_locked() == realtime.memory_locked());
    }
    CHECK((locked_kb() > 0) == (kLocks && realtime.memory_locked()));
    CHECK(policy() == (realtime.goes_first() ? SCHED_FIFO : SCHED_OTHER));
  }
  CHECK(policy() == SCHED_OTHER);
  CHECK(locked_kb() == 0);
}

TEST_CASE("a user without the rights is told once what to do, and allocations go on") {
  if (geteuid() != 0) return;  // only root can become one
  const tests::TemporaryFolder folder;
  const std::string said = folder.path() + "/said";
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (std::freopen(said.c_str(), "w", stderr) == nullptr || setuid(kNobody) != 0) _exit(1);
    const common::RealtimeThread one;
    const common::RealtimeThread other;
    const std::vector<char> much(64U << 20U, 1);
    _exit(one.goes_first() || one.memory_locked() || other.goes_first() || much.back() != 1 ? 2 : 0);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  std::ifstream file(said);
  std::string first;
  std::string second;
  std::getline(file, first);
  CHECK_THAT(first, Catch::Contains("no real-time priority and no locked memory") &&
                        Catch::Contains("/etc/security/limits.conf"));
  CHECK_FALSE(std::getline(file, second));
}
