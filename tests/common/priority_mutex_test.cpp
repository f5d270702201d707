#include "lodestone/common/priority_mutex.h"

#include <catch2/catch.hpp>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

using lodestone::common::PriorityMutex;

TEST_CASE("a priority mutex excludes, and conditions wait over it") {
  PriorityMutex mutex;
  std::condition_variable_any changed;
  int count = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 10000; ++i) {
        const std::lock_guard<PriorityMutex> lock(mutex);
        ++count;
      }
      changed.notify_all();
    });
  {
    std::unique_lock<PriorityMutex> lock(mutex);
    changed.wait(lock, [&] { return count == 40000; });
    CHECK(count == 40000);
    bool other = true;
    std::thread([&] { other = mutex.try_lock(); }).join();
    CHECK_FALSE(other);
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(mutex.try_lock());
  mutex.unlock();
}
