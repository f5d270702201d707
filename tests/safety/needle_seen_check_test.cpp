#include "lodestone/safety/needle_seen_check.h"

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {
control::PoseEstimate seen() {
  control::PoseEstimate estimate;
  estimate.valid = true;
  return estimate;
}
}  // namespace

TEST_CASE("every pulse needs a pose of its own") {
  safety::NeedleSeenCheck check;
  rig::CoilPulse pulse;
  CHECK_THROWS_AS(check.check(pulse, {}), safety::Distrust);
  check.observe(seen(), 0.0);
  check.check(pulse, {});
  CHECK_THROWS_WITH(check.check(pulse, {}), Catch::Contains("nobody has seen the needle"));
  check.observe(seen(), 0.0);
  check.forget();
  CHECK_THROWS_AS(check.check(pulse, {}), safety::Distrust);
}

TEST_CASE("a few weak probes need no pose, and are counted until there is one") {
  safety::NeedleSeenCheck check;
  rig::CoilPulse probe;
  probe.current_A = {0.0, 2.0, 1.5, 0.0};
  for (int i = 0; i < 6; ++i) check.check_probe(probe);
  CHECK_THROWS_WITH(check.check_probe(probe), Catch::Contains("6 probes"));
  check.observe(seen(), 0.0);
  check.check_probe(probe);
  CHECK_THROWS_AS(check.check(probe, {}), safety::Distrust);  // a probe uses the pose up
  probe.current_A[0] = 2.1;
  CHECK_THROWS_WITH(check.check_probe(probe), Catch::Contains("limit is 2 A"));
}
