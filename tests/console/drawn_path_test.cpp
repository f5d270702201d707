#include "lodestone/console/drawn_path.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

TEST_CASE("a line drawn by hand is smoothed, and its ends stay") {
  std::vector<Vector2> shaky;
  for (int i = 0; i <= 60; ++i) shaky.emplace_back(0.0005 * i - 0.015, (i % 2 == 0 ? 1.0 : -1.0) * 0.0004);
  const geometry::Path path = console::smoothed(shaky, false);
  CHECK((path.points_m().front() - shaky.front()).norm() < 1e-9);
  CHECK((path.points_m().back() - shaky.back()).norm() < 1e-9);
  CHECK(path.length_m() < 0.033);  // drawn: 56 mm
  for (const Vector2& point_m : path.points_m())
    if (std::abs(point_m.x()) < 0.01) CHECK(std::abs(point_m.y()) < 0.0002);
}

TEST_CASE("a closed line stays closed, and a straight one straight") {
  const geometry::Path ring = console::smoothed(geometry::Path::circle(0.015).points_m(), true);
  CHECK(ring.closed());
  for (const Vector2& point_m : ring.points_m()) CHECK(point_m.norm() == Approx(0.015).margin(0.0003));
  const geometry::Path line = console::smoothed({{0.0, 0.0}, {0.01, 0.0}}, false);
  CHECK(line.points_m().size() == 11);
  CHECK(line.at(0.005).x() == Approx(0.005));
  CHECK_THROWS_AS(console::smoothed({{0.0, 0.0}, {0.0, 0.0}}, false), common::DataError);
}

TEST_CASE("of the headings along a path so many are shown that they can be told apart") {
  const geometry::Path line({{0.0, 0.0}, {0.03, 0.0}}, false);
  CHECK(console::shown_headings(line).empty());
  const auto shown = console::shown_headings(line.with_heading(geometry::PathHeading::fixed(0.5)));
  REQUIRE(shown.size() == 6);
  CHECK(shown[1].x_m == Approx(0.0075));
  CHECK(shown[1].heading_rad == 0.5);
  const geometry::Path spiral({{0.0, 0.0}, {9.0, 0.0}}, false);  // as long as one
  CHECK(console::shown_headings(spiral.with_heading(geometry::PathHeading::tangent())).size() == 200);
}

TEST_CASE("a path is only followed where the needle can and may be") {
  console::Reachable reachable{tests::paper_rig(), 0.03, std::nullopt};
  const double radius_m = reachable.rig.dish.radius_m;
  CHECK(console::object_to(geometry::Path::square(0.02), reachable).why_not.empty());
  const console::PathObjection fence =
      console::object_to(geometry::Path({{0.0, 0.0}, {0.0, 0.0305}}, false), reachable);
  CHECK_THAT(fence.why_not, Catch::Contains("fence of 30.0 mm"));
  CHECK(fence.bad_m.size() == 1);
  CHECK_THAT(reachable.why_not({radius_m, 0.0}), Catch::Contains("outside the dish"));
  reachable.keep_out = {{{"vessel", {0.0, 0.01}, 0.002}}, 0.0235, 0.001, 0.001};
  const console::PathObjection zone =
      console::object_to(geometry::Path({{-0.01, 0.01}, {0.01, 0.01}}, false), reachable);
  CHECK_THAT(zone.why_not, Catch::Contains("keep-out zone vessel"));
  CHECK(zone.bad_m.size() == 7);  // 3.5 mm to both sides
  reachable.keep_out = {};
  std::vector<task::Move> moves(50, task::Move{{-0.002, 0.0}, {0.002, 0.0}});
  moves.insert(moves.end(), 50, task::Move{{0.002, 0.0}, {-0.002, 0.0}});
  reachable.region = task::Region(moves, task::RegionConfig{});
  CHECK(reachable.why_not({0.002, 0.0}).empty());
  CHECK_THAT(reachable.why_not({0.015, 0.01}), Catch::Contains("no needle was seen"));
}

TEST_CASE("what lies between the corners of a path counts, too") {
  std::vector<task::Move> moves;  // a corner: along x at the bottom, along y on the right
  for (int i = 0; i < 50; ++i)
    for (int cell = 0; cell < 5; ++cell) {
      const double at_m = 0.004 * cell - 0.006;
      moves.push_back({{at_m, -0.006}, {at_m + 0.004, -0.006}});
      moves.push_back({{at_m + 0.004, -0.006}, {at_m, -0.006}});
      moves.push_back({{0.014, at_m}, {0.014, at_m + 0.004}});
      moves.push_back({{0.014, at_m + 0.004}, {0.014, at_m}});
    }
  const console::Reachable reachable{tests::paper_rig(), 0.03, task::Region(moves, task::RegionConfig{})};
  const Vector2 left(-0.006, -0.006), corner(0.014, -0.006), top(0.014, 0.014);
  CHECK(console::object_to(geometry::Path({left, corner, top}, false), reachable).why_not.empty());
  const console::PathObjection across = console::object_to(geometry::Path({left, top}, false), reachable);
  CHECK_THAT(across.why_not, Catch::Contains("no needle was seen"));
  CHECK(across.bad_m.size() > 5);
}

TEST_CASE("a path is not endless") {
  std::vector<Vector2> points;
  for (int i = 0; i < 2000; ++i) points.emplace_back(i % 2 == 0 ? -0.01 : 0.01, 0.0);
  CHECK_THROWS_WITH(console::smoothed(points, false), Catch::Contains("at most 10 m"));
  const console::Reachable reachable{tests::paper_rig(), 0.03, std::nullopt};
  const console::PathObjection objection = console::object_to(geometry::Path(points, false), reachable);
  CHECK_THAT(objection.why_not, Catch::Contains("at most 10 m"));
  CHECK(objection.bad_m.empty());
  CHECK_THROWS_AS(console::smoothed({{0.0, 0.0}, {1e308, 0.0}, {-1e308, 0.0}}, false), common::DataError);
}
