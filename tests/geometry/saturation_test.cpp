#include "lodestone/geometry/saturation.h"

#include <catch2/catch.hpp>

using namespace lodestone;
using geometry::Vector2;

TEST_CASE("a single drive is cut at its limit") {
  CHECK(geometry::saturated(1.5) == 1.0);
  CHECK(geometry::saturated(-20.0, 15.0) == -15.0);
  CHECK(geometry::saturated(-3.0, 15.0) == -3.0);
}

TEST_CASE("saturation cuts each axis, or keeps the direction, and leaves what is within as it is") {
  CHECK(geometry::saturated({2.0, -0.25}) == Vector2(1.0, -0.25));
  CHECK(geometry::saturated({-20.0, 3.0}, 15.0) == Vector2(-15.0, 3.0));
  CHECK(geometry::saturated_in_direction({2.0, -0.25}) == Vector2(1.0, -0.125));
  for (const Vector2& within : {Vector2(0.3, -1.0), Vector2(0.0, 0.0), Vector2(1.0, 1.0)}) {
    CHECK(geometry::saturated(within) == within);
    CHECK(geometry::saturated_in_direction(within) == within);
  }
}
