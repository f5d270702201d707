#include "lodestone/geometry/stitch.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

using namespace lodestone;
using geometry::kPi;
using geometry::Stitch;
using geometry::Vector2;

TEST_CASE("a running stitch crosses its wound back and forth, around the centre") {
  const std::vector<Stitch> stitches = geometry::running_stitch(5, 0.006, 0.004);
  REQUIRE(stitches.size() == 5);
  for (std::size_t i = 0; i < stitches.size(); ++i) {
    const double up = i % 2 == 0 ? 1.0 : -1.0;
    CHECK(stitches[i].entry.x_m == Approx(0.004 * (static_cast<double>(i) - 2.0)).margin(1e-12));
    CHECK(stitches[i].exit.x_m == stitches[i].entry.x_m);
    CHECK(stitches[i].entry.y_m == Approx(-up * 0.003));
    CHECK(stitches[i].exit.y_m == Approx(up * 0.003));
    CHECK(stitches[i].entry.heading_rad == Approx(up * 0.5 * kPi));
    CHECK(stitches[i].exit.heading_rad == Approx(up * 0.5 * kPi));
  }
  CHECK(geometry::running_stitch(2, 0.006, 0.004).front().entry.x_m == Approx(-0.002));
  CHECK(geometry::running_stitch(1, 0.006, 0.004).front().entry.x_m == 0.0);
  CHECK_THROWS_AS(geometry::running_stitch(0, 0.006, 0.004), common::LogicFault);
}

TEST_CASE("the way through a stitch in line is straight, from before its entry to behind its exit") {
  const Stitch up = geometry::running_stitch(1, 0.006, 0.004).front();
  const geometry::Path way = geometry::way_through(up, 0.003, 0.002);
  CHECK(way.length_m() == Approx(0.011));
  CHECK_FALSE(way.closed());
  CHECK(way.at(0.0).y() == Approx(-0.006));
  CHECK(way.at(0.003).y() == Approx(-0.003));
  CHECK(way.at(0.009).y() == Approx(0.003));
  CHECK(way.at(0.011).y() == Approx(0.005));
  for (int i = 0; i <= 22; ++i) {
    CHECK(std::abs(way.at(0.0005 * i).x()) < 1e-12);
    CHECK(way.at(0.0005 * i).y() == Approx(-0.006 + 0.0005 * i).margin(1e-9));
    CHECK(*way.heading_rad(0.0005 * i) == Approx(0.5 * kPi));
  }
  CHECK(geometry::way_through(up, 0.0, 0.0).length_m() == Approx(0.006));
}

TEST_CASE(
    "a stitch that turns leaves its entry and comes to its exit at their headings, and lies along its way") {
  const Stitch arch{{-0.003, 0.0, 0.5 * kPi}, {0.003, 0.0, -0.5 * kPi}};
  const geometry::Path way = geometry::way_through(arch, 0.002, 0.002);
  CHECK(*way.heading_rad(0.001) == Approx(0.5 * kPi));
  CHECK(*way.heading_rad(way.length_m() - 0.001) == Approx(-0.5 * kPi));
  CHECK((way.at(0.002) - Vector2(-0.003, 0.0)).norm() < 1e-12);
  const double top_m = 0.5 * way.length_m();
  CHECK(std::abs(way.at(top_m).x()) < 1e-9);
  CHECK(way.at(top_m).y() == Approx(0.0015));  // a quarter of the tangents' length
  CHECK(*way.heading_rad(top_m) == Approx(0.0).margin(1e-9));
  for (double at_m = 0.0; at_m < way.length_m() - 2e-4; at_m += 1e-4) {
    const Vector2 along_m = way.at(at_m + 1e-4) - way.at(at_m);
    const double off_rad =
        geometry::wrap_angle(*way.heading_rad(at_m + 0.5e-4) - std::atan2(along_m.y(), along_m.x()));
    CHECK(std::abs(off_rad) < 0.06);
  }
}

TEST_CASE("through stitches in a row the way leads on from each to the next one") {
  const auto stitches = geometry::running_stitch(2, 0.006, 0.004);
  const geometry::Path way = geometry::way_through_all(stitches, 0.003, 0.003);
  CHECK(way.length_m() == Approx(0.012 + 0.004 + 0.012));
  CHECK((way.at(0.012) - Vector2(-0.002, 0.006)).norm() < 1e-9);
  CHECK((way.at(0.016) - Vector2(0.002, 0.006)).norm() < 1e-9);
  CHECK(*way.heading_rad(0.006) == Approx(0.5 * kPi));
  CHECK(*way.heading_rad(0.022) == Approx(-0.5 * kPi));
  CHECK_THROWS_AS(geometry::way_through_all({}, 0.003, 0.003), common::DataError);
}

TEST_CASE("a stitch at one point is none") {
  CHECK_THROWS_AS(geometry::way_through({{0.001, 0.0, 0.0}, {0.001, 0.0, 1.0}}, 0.003, 0.003),
                  common::DataError);
}
