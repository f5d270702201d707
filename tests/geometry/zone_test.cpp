#include "lodestone/geometry/zone.h"

#include <catch2/catch.hpp>

#include "lodestone/common/config.h"

using namespace lodestone;
using geometry::Vector2;
using geometry::Zone;

TEST_CASE("a disc, a wall and a polygon are as far as their nearest point") {
  const Zone disc{"", {0.01, 0.0}, 0.004};
  CHECK(disc.distance_m({0.0, 0.0}, {0.0, 0.0}) == Approx(0.006));
  CHECK(disc.distance_m({0.01, 0.0}, {0.01, 0.0}) == Approx(-0.004));
  CHECK(disc.distance_m({0.0, 0.01}, {0.02, 0.01}) == Approx(0.006));  // in the middle of the segment
  const Zone wall{"", {0.0, -0.01, 0.0, 0.01}, 0.001};
  CHECK(wall.distance_m({0.005, 0.0}, {0.02, 0.0}) == Approx(0.004));
  CHECK(wall.distance_m({-0.005, 0.002}, {0.005, 0.002}) == Approx(-0.001));  // across it
  CHECK(wall.distance_m({0.0, 0.02}, {0.0, 0.03}) == Approx(0.009));          // beyond its end
  const Zone square{"", {0.0, 0.0, 0.01, 0.0, 0.01, 0.01, 0.0, 0.01}, 0.0};
  CHECK(square.distance_m({0.013, 0.014}, {0.02, 0.02}) == Approx(0.005));  // from its corner
  CHECK(square.distance_m({0.005, 0.005}, {0.006, 0.005}) == 0.0);          // wholly inside
  CHECK(square.distance_m({-0.01, 0.005}, {0.02, 0.006}) == 0.0);           // right through
}

TEST_CASE("a point is as far from a segment as from the nearest point of it") {
  CHECK(geometry::to_segment_m({0.005, 0.003}, {0.0, 0.0}, {0.01, 0.0}) == Approx(0.003));
  CHECK(geometry::to_segment_m({0.013, 0.004}, {0.0, 0.0}, {0.01, 0.0}) == Approx(0.005));
  CHECK(geometry::to_segment_m({0.003, 0.004}, {0.0, 0.0}, {0.0, 0.0}) == Approx(0.005));
}

TEST_CASE("the hollow of a polygon is no part of it") {
  // Like a U, open upwards.
  const Zone cup{
      "", {0.0, 0.0, 0.03, 0.0, 0.03, 0.03, 0.02, 0.03, 0.02, 0.01, 0.01, 0.01, 0.01, 0.03, 0.0, 0.03}, 0.0};
  CHECK(cup.distance_m({0.015, 0.02}, {0.015, 0.02}) == Approx(0.005));
  CHECK(cup.distance_m({0.015, 0.005}, {0.015, 0.005}) == 0.0);
}

TEST_CASE("a zone is read strictly, and says what it is called") {
  const auto read = [](const common::Json& json) { return common::config_from_json<Zone>(json, "rig.json"); };
  CHECK(read({{"name", "wall"}, {"corners_m", {0.0, 0.0, 0.01, 0.0}}}).called() == "wall");
  CHECK(read({{"corners_m", {0.01, -0.02}}, {"radius_m", 0.004}}).called() == "at (10.0, -20.0) mm");
  CHECK_THROWS_WITH(read({{"radius_m", 0.004}}), Catch::Contains("corners_m") && Catch::Contains("rig.json"));
  CHECK_THROWS_WITH(read({{"corners_m", {0.0, 0.0, 0.01}}}), Catch::Contains("corners_m"));
  CHECK_THROWS_WITH(read({{"corners_m", {0.0, 0.0}}}), Catch::Contains("radius_m"));
  CHECK_THROWS_WITH(read({{"corners_m", {10.0, 0.0}}, {"radius_m", 0.004}}), Catch::Contains("corners_m"));
  CHECK_THROWS_WITH(read({{"corners", {0.0, 0.0}}}), Catch::Contains("corners"));
}
