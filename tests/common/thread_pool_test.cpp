#include "lodestone/common/thread_pool.h"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <cfenv>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "lodestone/common/error.h"

using lodestone::common::DenormalsFlushed;
using lodestone::common::ThreadPool;

TEST_CASE("every shard runs exactly once, at any number of threads") {
  for (const std::size_t threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    CHECK(pool.size() == threads);
    for (const std::size_t shards : {0, 1, 3, 100}) {
      std::vector<int> runs(shards, 0);
      for (int repeat = 0; repeat < 50; ++repeat)
        pool.for_each(shards, [&runs](std::size_t shard) { ++runs[shard]; });
      CHECK(runs == std::vector<int>(shards, 50));
    }
  }
}

TEST_CASE("an exception in a shard reaches the caller and the pool goes on") {
  ThreadPool pool(2);
  CHECK_THROWS_AS(pool.for_each(8,
                                [](std::size_t shard) {
                                  if (shard == 5) throw std::runtime_error("five");
                                }),
                  std::runtime_error);
  int sum = 0;
  ThreadPool(1).for_each(4, [&sum](std::size_t shard) { sum += static_cast<int>(shard); });
  CHECK(sum == 6);
  std::vector<int> runs(8, 0);
  pool.for_each(8, [&runs](std::size_t shard) { runs[shard] = 1; });
  CHECK(runs == std::vector<int>(8, 1));
}

TEST_CASE("denormal numbers are flushed only while that is asked for", "[unit]") {
  volatile double smallest = 2.3e-308;
  bool kept_before = false;
  bool flushed_within = false;
  bool kept_after = false;
  std::thread([&] {
    std::fesetenv(FE_DFL_ENV);  // whatever pools have set in the thread that made this one
    kept_before = smallest / 4.0 > 0.0;
    {
      const DenormalsFlushed flushed;
      flushed_within = smallest / 4.0 == 0.0;
      const ThreadPool pool(1);  // sets it, too
    }
    kept_after = smallest / 4.0 > 0.0;
  }).join();
  CHECK(kept_before);
  CHECK(flushed_within);
  CHECK(kept_after);
}

#ifndef __SANITIZE_ADDRESS__  // which takes what addresses there are
TEST_CASE("where the system gives no more threads, the pool says so and lets go those that it has") {
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_AS, &before) == 0);
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  constexpr std::size_t kPage = 4096, kFewStacks = 64 << 20;
  const rlimit tight{pages * kPage + kFewStacks, before.rlim_max};
  REQUIRE(setrlimit(RLIMIT_AS, &tight) == 0);
  std::string said;
  try {
    const ThreadPool pool(1000);
  } catch (const lodestone::common::IoError& error) {
    said = error.what();
  }
  setrlimit(RLIMIT_AS, &before);
  CHECK(said.find("cannot start 1000 threads: no more than") != std::string::npos);
  const ThreadPool after(2);
  CHECK(after.size() == 2);
}
#endif
