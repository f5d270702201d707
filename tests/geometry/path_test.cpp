#include "lodestone/geometry/path.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone::geometry;

TEST_CASE("a square has its length, corners and cross-track distances") {
  const Path square = Path::square(0.02);
  CHECK(square.closed());
  CHECK(square.length_m() == Approx(0.08));
  CHECK((square.at(0.01) - Vector2(0.01, 0.0)).norm() < 1e-12);
  CHECK((square.at(0.08 + 0.02) - Vector2(0.01, 0.01)).norm() < 1e-12);
  CHECK((square.at(-0.02) - Vector2(-0.01, -0.01)).norm() < 1e-12);
  const Path::Nearest nearest = square.nearest({0.013, 0.004});
  CHECK(nearest.distance_m == Approx(0.003));
  CHECK(nearest.arc_m == Approx(0.014));
}

TEST_CASE("corners are where a path turns sharply, and the ends of an open one") {
  const auto corners = Path::square(0.02).corners_m();
  REQUIRE(corners.size() == 4);
  CHECK((corners[0] - Vector2(0.01, -0.01)).norm() < 1e-12);
  CHECK((corners[3] - Vector2(-0.01, -0.01)).norm() < 1e-12);
  CHECK(Path::circle(0.015).corners_m().empty());
  const Path hook({{0.0, 0.0}, {0.01, 0.0}, {0.01, 0.0}, {0.02, 0.001}, {0.02, 0.02}}, false);
  const auto turns = hook.corners_m();
  REQUIRE(turns.size() == 3);
  CHECK((turns[1] - Vector2(0.02, 0.001)).norm() < 1e-12);
}

TEST_CASE("a circle stays within its polygon's error of the true circle") {
  const Path circle = Path::circle(0.015);
  for (int i = 0; i < 50; ++i) {
    const double radius = circle.at(circle.length_m() * i / 50.0).norm();
    CHECK(std::abs(radius - 0.015) < 0.015 * (1.0 - std::cos(kPi / 180.0)) + 1e-12);
  }
  CHECK(circle.nearest({0.0, 0.0}).distance_m == Approx(0.015).epsilon(1e-3));
}

TEST_CASE("an open path stops at its ends") {
  const Path path({{0.0, 0.0}, {0.01, 0.0}}, false);
  CHECK((path.at(1.0) - Vector2(0.01, 0.0)).norm() < 1e-12);
  CHECK((path.at(-1.0) - Vector2(0.0, 0.0)).norm() < 1e-12);
  CHECK_THROWS_AS(Path({{0.0, 0.0}}, false), lodestone::common::DataError);
  CHECK_THROWS_AS(Path({{1.0, 0.0}, {1.0, 0.0}}, false), lodestone::common::DataError);
}

TEST_CASE("a path is read from CSV, closed where it ends as it begins") {
  const lodestone::tests::TemporaryFolder folder;
  std::ofstream(folder / "good.csv") << "x_m,y_m\r\n0,0\r\n 1e-2 , 0\r\n\r\n0.01,0.01\r\n0,0\r\n";
  const Path path = Path::from_csv(folder / "good.csv");
  CHECK(path.closed());
  CHECK(path.length_m() == Approx(0.02 + std::sqrt(2.0) * 0.01));
}

TEST_CASE("a path wants no heading unless it is given one, and keeps its way with one") {
  const Path square = Path::square(0.02);
  CHECK_FALSE(square.heading_rad(0.01));
  CHECK(square.poses(0.005).empty());
  const Path headed = square.with_heading(PathHeading::tangent());
  CHECK(headed.at(0.013) == square.at(0.013));
  CHECK(headed.closed());
  CHECK(*headed.heading_rad(0.01) == Approx(kPi / 2.0));  // up its right side
  CHECK(*headed.heading_rad(0.03) == Approx(kPi));
  CHECK(*headed.heading_rad(0.05) == Approx(-kPi / 2.0));
  CHECK(*headed.heading_rad(0.07) == Approx(0.0).margin(1e-12));
  CHECK(*headed.heading_rad(0.0) == Approx(kPi / 2.0));  // at a corner, as on the way on
  CHECK(*headed.heading_rad(0.08 + 0.01) == Approx(kPi / 2.0));
  CHECK_FALSE(headed.with_heading({}).heading_rad(0.01));
  CHECK(*square.with_heading(PathHeading::fixed(0.5)).heading_rad(0.07) == 0.5);
}

TEST_CASE("the tangent of a circle turns with it, and that of a doubled end is that of the way there") {
  const Path circle = Path::circle(0.015).with_heading(PathHeading::tangent());
  for (int i = 0; i < 60; ++i) {
    const double angle_rad = 2.0 * kPi * (i + 0.5) / 60.0;
    const double heading_rad = *circle.heading_rad(circle.length_m() * angle_rad / (2.0 * kPi));
    CHECK(std::abs(wrap_angle(heading_rad - angle_rad - kPi / 2.0)) < 0.02);  // of its polygon
  }
  const Path doubled({{0.0, 0.0}, {0.0, 0.01}, {0.0, 0.01}}, false);
  CHECK(*doubled.with_heading(PathHeading::tangent()).heading_rad(0.01) == Approx(kPi / 2.0));
}

TEST_CASE("poses along a path are where it goes, evenly, and lie as it says") {
  const auto poses = Path::square(0.02).with_heading(PathHeading::tangent()).poses(0.01);
  REQUIRE(poses.size() == 8);
  CHECK(poses[0].x_m == Approx(0.01));
  CHECK(poses[0].y_m == Approx(-0.005));
  CHECK(poses[1].heading_rad == Approx(kPi / 2.0));
  CHECK(poses[2].heading_rad == Approx(kPi));
  CHECK(Path({{0.0, 0.0}, {0.001, 0.0}}, false).with_heading(PathHeading::fixed(1.0)).poses(0.01).size() ==
        1);
}

TEST_CASE("a path has the headings of its file, one for each point") {
  const lodestone::tests::TemporaryFolder folder;
  const std::string file = folder / "headed.csv";
  std::ofstream(file) << "x_m,y_m,heading_rad\n0,0,0\n0.01,0,1\n0.01,0.01,3\n0,0,0\n";
  const Path path = Path::from_csv(file);
  CHECK(path.closed());
  CHECK(path.heading().rule() == HeadingRule::kColumn);
  CHECK(*path.heading_rad(0.005) == Approx(0.5));
  CHECK(*path.heading_rad(0.015) == Approx(2.0));
  CHECK_THROWS_WITH(read_points_csv(file), Catch::Contains("must be x_m,y_m, found"));
  std::ofstream(file) << "x_m,y_m\n0,0\n0.01,0\n";
  CHECK(Path::from_csv(file).heading().rule() == HeadingRule::kNone);
  std::ofstream(file) << "x_m,y_m,heading\n0,0,0\n0.01,0,1\n";
  CHECK_THROWS_WITH(Path::from_csv(file),
                    Catch::Contains("headed.csv:1: the header must be x_m,y_m or x_m,y_m,heading_rad"));
  std::ofstream(file) << "x_m,y_m,heading_rad\n0,0,0\n0.01,0,inf\n";
  CHECK_THROWS_WITH(Path::from_csv(file), Catch::Contains("headed.csv:3: column 3 (heading_rad)"));
  CHECK_THROWS_WITH(path.with_heading(PathHeading::column({0.0, 1.0})),
                    Catch::Contains("4 points has 2 headings"));
}

TEST_CASE("points that cannot be read are named by file, line and column") {
  const lodestone::tests::TemporaryFolder folder;
  const std::string file = folder / "points.csv";
  const char* const bad[][2] = {{"x,y\n0,0\n", ":1: the header must be x_m,y_m, found \"x,y\""},
                                {"x_m,y_m\n0,0\n0.01,oops\n", ":3: column 2 (y_m)"},
                                {"x_m,y_m\nnan,0\n", ":2: column 1 (x_m)"},
                                {"x_m,y_m\n0.1\n", ":2: column 2 (y_m) is missing"},
                                {"x_m,y_m\n0.1,0.2,0.3\n", ":2: column 3 is one too many"},
                                {"x_m,y_m\n", "no points"},
                                {"", "empty"}};
  for (const auto& [content, message] : bad) {
    std::ofstream(file) << content;
    CHECK_THROWS_WITH(read_points_csv(file), Catch::Contains("points.csv") && Catch::Contains(message));
    CHECK_THROWS_AS(read_points_csv(file), lodestone::common::DataError);
  }
}
