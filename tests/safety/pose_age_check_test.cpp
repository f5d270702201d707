#include "lodestone/safety/pose_age_check.h"

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {
control::PoseEstimate seen_at(double stamp_s) {
  control::PoseEstimate estimate;
  estimate.valid = true;
  estimate.stamp_s = stamp_s;
  return estimate;
}
}  // namespace

TEST_CASE("a pose is new and young") {
  safety::PoseAgeCheck check(0.5);
  check.observe(seen_at(10.0), 10.4);
  check.observe(seen_at(10.0), 10.4);  // at the same instant the same pose may come twice
  check.observe(seen_at(10.3), 10.7);
  CHECK_THROWS_WITH(check.observe(seen_at(10.3), 10.75), Catch::Contains("the same pose, or an older one"));
  CHECK_THROWS_WITH(check.observe(seen_at(11.0), 11.6),
                    Catch::Contains("the pose is 0.6 s old, limit is 0.5 s"));
  CHECK_THROWS_WITH(check.observe(seen_at(12.6), 12.0), Catch::Contains("clock set"));
}
