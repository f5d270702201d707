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
  safety::NeedleSeenCheck check(0.5);
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
  safety::NeedleSeenCheck check(0.5);
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

TEST_CASE("a pulse that comes long after its pose is refused") {
  safety::NeedleSeenCheck check(0.5);
  rig::CoilPulse pulse;
  safety::PulseContext context;
  control::PoseEstimate pose = seen();
  pose.stamp_s = 10.0;
  context.now_s = 10.5;
  check.observe(pose, 10.1);
  check.check(pulse, context);
  context.now_s = 10.6;
  check.observe(pose, 10.1);
  CHECK_THROWS_WITH(check.check(pulse, context), Catch::Contains("0.6 s after the pose"));
}
