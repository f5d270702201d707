#include "lodestone/common/resource_use.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <thread>
#include <vector>

#include "lodestone/common/thread_name.h"

TEST_CASE("the peak of memory rises with what is held, in MB, and does not fall again") {
  const double before_mb = lodestone::common::peak_memory_mb();
  CHECK(before_mb > 1.0);
  {
    const std::vector<char> held(static_cast<std::size_t>(2.0 * before_mb * 1e6), 1);
    CHECK(held.back() == 1);
    CHECK(lodestone::common::peak_memory_mb() > 2.0 * before_mb);
  }
  CHECK(lodestone::common::peak_memory_mb() > 2.0 * before_mb);
}

TEST_CASE("processor_seconds grows with work") {
  const double before_s = lodestone::common::processor_seconds();
  volatile double sum = 0.0;
  for (int i = 0; i < 20000000; ++i) sum = sum + 1.0 / (1.0 + i);
  CHECK(before_s > 0.0);
  CHECK(lodestone::common::processor_seconds() > before_s);
}

TEST_CASE("what other programs use of the machine is counted, and one's own work is taken off once") {
  const auto used_by_others_s = [](const auto& work) {
    const auto before_s = lodestone::common::other_processor_seconds();
    REQUIRE(before_s);
    work();
    return *lodestone::common::other_processor_seconds() - *before_s;
  };
  const auto work_elsewhere = [] {
    CHECK(std::system("i=0; while [ $i -lt 400000 ]; do i=$((i+1)); done") == 0);
  };
  CHECK(used_by_others_s(work_elsewhere) > 0.0);
  constexpr double kWorkS = 0.5, kCountedInS = 0.01;
  const auto work_here = [until_s = lodestone::common::processor_seconds() + kWorkS] {
    while (lodestone::common::processor_seconds() < until_s) {
    }
  };
  CHECK(used_by_others_s(work_here) > -10.0 * kCountedInS);
}

TEST_CASE("what threads have used is told by their names") {
  std::atomic<bool> worked{false}, over{false};
  std::thread worker([&] {
    lodestone::common::name_thread("hard-worker");
    volatile double sum = 0.0;
    for (int i = 0; i < 20000000; ++i) sum = sum + 1.0 / (1.0 + i);
    worked = true;
    while (!over) std::this_thread::yield();
  });
  while (!worked) std::this_thread::yield();
  const auto used_s = lodestone::common::processor_seconds_by_thread();
  over = true;
  worker.join();
  REQUIRE(used_s.count("hard-worker") == 1);
  CHECK(used_s.size() >= 2);
}
