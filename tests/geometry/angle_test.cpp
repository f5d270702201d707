#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone::geometry;

TEST_CASE("angles wrap into (-pi, pi]") {
  CHECK(wrap_angle(0.0) == 0.0);
  CHECK(wrap_angle(3.0 * kPi) == Approx(kPi));
  CHECK(wrap_angle(-kPi) == Approx(kPi));
  CHECK(wrap_angle(-3.5 * kPi) == Approx(0.5 * kPi));
}
