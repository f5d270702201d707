#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone::geometry;

TEST_CASE("angles wrap into (-pi, pi]") {
  CHECK(wrap_angle(0.0) == 0.0);
  CHECK(wrap_angle(3.0 * geometry::kPi) == Approx(geometry::kPi));
  CHECK(wrap_angle(-geometry::kPi) == Approx(geometry::kPi));
  CHECK(wrap_angle(-3.5 * geometry::kPi) == Approx(0.5 * geometry::kPi));
}
