#include "lodestone/geometry/polygon.h"

#include <catch2/catch.hpp>
#include <vector>

using namespace lodestone;
using geometry::Vector2;

namespace {

const std::vector<Vector2> kRectangle = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {0.0, 2.0}};
/// A rectangle out of whose top a notch is cut.
const std::vector<Vector2> kNotched = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {2.0, 0.5}, {0.0, 2.0}};

}  // namespace

TEST_CASE("an outline has its area, with the sign of its sense") {
  CHECK(geometry::signed_area_m2(kRectangle) == Approx(8.0));
  CHECK(geometry::signed_area_m2({kRectangle.rbegin(), kRectangle.rend()}) == Approx(-8.0));
  CHECK(geometry::signed_area_m2(kNotched) == Approx(5.0));
}

TEST_CASE("a point lies within an outline or out of it, in a notch too") {
  for (const auto& outline : {kRectangle, kNotched}) {
    CHECK(geometry::inside_polygon(outline, {0.5, 0.5}));
    CHECK(geometry::inside_polygon(outline, {3.5, 1.0}));
    CHECK_FALSE(geometry::inside_polygon(outline, {-0.5, 1.0}));
    CHECK_FALSE(geometry::inside_polygon(outline, {4.5, 1.0}));
    CHECK_FALSE(geometry::inside_polygon(outline, {2.0, -0.1}));
  }
  CHECK(geometry::inside_polygon(kRectangle, {2.0, 1.5}));
  CHECK_FALSE(geometry::inside_polygon(kNotched, {2.0, 1.5}));
}

TEST_CASE("segments cross where each has the other's ends on either side") {
  CHECK(geometry::segments_cross({0.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {2.0, 0.0}));
  CHECK_FALSE(geometry::segments_cross({0.0, 0.0}, {2.0, 2.0}, {0.0, 1.0}, {1.0, 3.0}));
  CHECK_FALSE(geometry::segments_cross({0.0, 0.0}, {2.0, 2.0}, {1.0, 1.0}, {1.0, 3.0}));  // ends on it
  CHECK_FALSE(geometry::segments_cross({0.0, 0.0}, {2.0, 2.0}, {3.0, 3.0}, {4.0, 4.0}));  // in line
}

TEST_CASE("the outline of one body has three corners and does not meet itself") {
  CHECK(geometry::is_simple_polygon(kRectangle));
  CHECK(geometry::is_simple_polygon(kNotched));
  CHECK(geometry::is_simple_polygon({kNotched.rbegin(), kNotched.rend()}));
  CHECK_FALSE(geometry::is_simple_polygon({{0.0, 0.0}, {1.0, 0.0}}));
  CHECK_FALSE(geometry::is_simple_polygon({{0.0, 0.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}}));  // a bow tie
  CHECK_FALSE(geometry::is_simple_polygon({{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}));  // one twice
  CHECK_FALSE(geometry::is_simple_polygon({{0.0, 0.0}, {2.0, 0.0}, {1.0, 0.0}}));              // a line
  // A notch as deep as the body parts it in two that touch in a point.
  CHECK_FALSE(geometry::is_simple_polygon({{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {2.0, 0.0}, {0.0, 2.0}}));
}
