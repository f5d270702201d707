#include "lodestone/common/interruption.h"

#include <catch2/catch.hpp>
#include <thread>

#include "lodestone/common/clock.h"

using namespace lodestone;

TEST_CASE("an interruption ends a wait that has begun, and every later one until it is cleared") {
  common::Interruption interruption;
  common::SteadyClock clock;
  std::thread raiser([&] { interruption.raise(); });
  CHECK_FALSE(clock.wait_until(clock.now_s() + 3600.0, &interruption));
  raiser.join();
  CHECK(interruption.raised());
  CHECK_FALSE(clock.wait_until(clock.now_s() + 3600.0, &interruption));
  CHECK_FALSE(clock.wait_until(clock.now_s() - 1.0, &interruption));
  interruption.clear();
  CHECK(clock.wait_until(clock.now_s() + 1e-3, &interruption));
  CHECK(clock.wait_until(clock.now_s() - 1.0, nullptr));
}
