#include "lodestone/safety/needle_seen_check.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("every pulse needs a pose of its own") {
  safety::NeedleSeenCheck check;
  rig::CoilPulse pulse;
  CHECK_THROWS_AS(check.check(pulse, {}), safety::Distrust);
  check.observe({}, 0.0);
  check.check(pulse, {});
  CHECK_THROWS_WITH(check.check(pulse, {}), Catch::Contains("nobody has seen the needle"));
  check.observe({}, 0.0);
  check.forget();
  CHECK_THROWS_AS(check.check(pulse, {}), safety::Distrust);
}
