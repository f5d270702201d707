#include "lodestone/geometry/path_heading.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone::geometry;

TEST_CASE("without a rule a needle may lie any way") {
  const PathHeading heading;
  CHECK(heading.rule() == HeadingRule::kNone);
  CHECK_FALSE(heading.at(0, 0.5, {0.01, 0.0}));
}

TEST_CASE("a tangent heading is the way's own, a fixed one the same everywhere") {
  const PathHeading tangent = PathHeading::tangent();
  CHECK(*tangent.at(3, 0.5, {0.0, 0.01}) == Approx(kPi / 2.0));
  CHECK(*tangent.at(3, 0.5, {-0.01, -0.01}) == Approx(-0.75 * kPi));
  CHECK(*tangent.at(3, 0.5, {-0.01, -0.0}) == Approx(kPi));  // never -pi
  const PathHeading fixed = PathHeading::fixed(1.5 * kPi);
  CHECK(*fixed.at(0, 0.0, {0.01, 0.0}) == Approx(-kPi / 2.0));
  CHECK(*fixed.at(7, 0.9, {0.0, 0.01}) == *fixed.at(0, 0.0, {0.01, 0.0}));
  CHECK(fixed.points() == 0);
}

TEST_CASE("between two points a heading turns the shorter way around") {
  const PathHeading heading = PathHeading::column({0.0, 1.0, 3.0, -3.0, 100.0 * kPi});
  CHECK(heading.points() == 5);
  const Vector2 way_m(0.01, 0.0);
  CHECK(*heading.at(0, 0.25, way_m) == Approx(0.25));
  CHECK(*heading.at(1, 0.0, way_m) == Approx(1.0));
  CHECK(*heading.at(1, 1.0, way_m) == Approx(3.0));
  // From 3 to -3 it is 0.28 rad over pi, and 6 rad back over 0.
  CHECK(std::abs(*heading.at(2, 0.5, way_m)) == Approx(kPi).margin(1e-9));
  CHECK(*heading.at(2, 0.25, way_m) == Approx(3.0 + 0.25 * (2.0 * kPi - 6.0)));
  CHECK(*heading.at(2, 0.75, way_m) == Approx(-3.0 - 0.25 * (2.0 * kPi - 6.0)));
  CHECK(*heading.at(3, 1.0, way_m) == Approx(0.0).margin(1e-9));
}
