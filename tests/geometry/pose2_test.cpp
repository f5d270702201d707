#include "lodestone/geometry/pose2.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone::geometry;

TEST_CASE("angles wrap into (-pi, pi]") {
  CHECK(wrap_angle(0.0) == 0.0);
  CHECK(wrap_angle(3.0 * M_PI) == Approx(M_PI));
  CHECK(wrap_angle(-M_PI) == Approx(M_PI));
  CHECK(wrap_angle(-3.5 * M_PI) == Approx(0.5 * M_PI));
}
