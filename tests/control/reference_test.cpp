#include "lodestone/control/reference.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;
using geometry::Vector2;

TEST_CASE("a point stays where it is for its time") {
  control::PointReference reference({0.01, 0.02}, 3.0, 0.5);
  CHECK(reference.target(2.0, {0.0, 0.0}) == Vector2(0.01, 0.02));
  CHECK(reference.target_heading_rad() == 0.5);
  CHECK_FALSE(reference.finished(2.9));
  CHECK(reference.finished(3.0));
}

TEST_CASE("a path waits at its start for the needle, then moves along at its speed") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.002;
  config.approach_radius_m = 0.003;
  config.approach_limit_s = 20.0;
  control::PathReference reference(geometry::Path({{0.0, 0.0}, {0.02, 0.0}}, false), config);
  CHECK(reference.duration_s() == Approx(10.0));
  CHECK(reference.target(1.0, {0.01, 0.01}) == Vector2(0.0, 0.0));
  CHECK(reference.approaching());
  CHECK_FALSE(reference.finished(19.0));
  SECTION("the needle has come") {
    CHECK(reference.target(4.0, {0.001, 0.001}) == Vector2(0.0, 0.0));
    CHECK_FALSE(reference.approaching());
    CHECK(reference.target(7.0, {0.01, 0.01}).x() == Approx(0.006));
    CHECK(reference.finished(14.0));
  }
  SECTION("it never comes") {
    CHECK(reference.target(20.0, {0.01, 0.01}) == Vector2(0.0, 0.0));
    CHECK(reference.target(21.0, {0.01, 0.01}).x() == Approx(0.002));
  }
  reference.reset();
  CHECK(reference.approaching());
}

TEST_CASE("what lies ahead of a moving target is told, up to the end of the path") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.002;
  control::PathReference reference(geometry::Path::square(0.02), config);
  reference.target(1.0, {0.04, 0.0});
  CHECK(reference.ahead(1.0, 0.5, 3).empty());  // when it sets out depends on the needle
  reference.target(2.0, {0.01, -0.01});
  const auto ahead = reference.ahead(3.0, 0.5, 100);
  REQUIRE(ahead.size() == 100);
  CHECK(ahead[0].in_s == 0.5);
  CHECK((ahead[0].point_m - Vector2(0.01, -0.01 + 0.003)).norm() < 1e-12);
  CHECK((ahead[19].point_m - Vector2(0.01 - 0.002, 0.01)).norm() < 1e-12);  // around the first corner
  CHECK((ahead[99].point_m - Vector2(0.01, -0.01)).norm() < 1e-12);         // the end, not the next lap
  CHECK(control::PointReference({0.01, 0.0}, 3.0).ahead(0.0, 0.3, 5).empty());
}

TEST_CASE("a path has its heading from the approach on, at a corner that of the way on, ahead likewise") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.002;
  config.laps = 2;
  control::PathReference reference(
      geometry::Path::square(0.02).with_heading(geometry::PathHeading::tangent()), config);
  constexpr double kUp = geometry::kPi / 2.0, kLeft = geometry::kPi;
  reference.target(1.0, {0.04, 0.0});
  REQUIRE(reference.target_heading_rad());
  CHECK(*reference.target_heading_rad() == Approx(kUp));
  const auto waiting = reference.ahead(1.0, 0.5, 3);
  REQUIRE(waiting.size() == 3);  // it is no point to stay at
  CHECK((waiting[2].point_m - Vector2(0.01, -0.01)).norm() < 1e-12);
  CHECK(*waiting[2].heading_rad == Approx(kUp));
  double time_s = 1.7;
  reference.target(time_s, {0.01, -0.01});
  const auto heading_after = [&](double in_s) {
    reference.target(time_s + in_s, {0.01, 0.0});
    return *reference.target_heading_rad();
  };
  CHECK(heading_after(9.9) == Approx(kUp));
  CHECK(heading_after(10.0) == Approx(kLeft));
  CHECK(std::abs(heading_after(39.9)) < 1e-9);
  CHECK(heading_after(40.0) == Approx(kUp));    // the second time round
  CHECK(std::abs(heading_after(80.0)) < 1e-9);  // the end
  CHECK(std::abs(heading_after(80.2)) < 1e-9);
  const auto ahead = reference.ahead(time_s + 9.0, 0.5, 200);
  CHECK(*ahead[0].heading_rad == Approx(kUp));
  CHECK(*ahead[1].heading_rad == Approx(kLeft));
  CHECK(std::abs(*ahead[199].heading_rad) < 1e-9);
  reference.reset();
  CHECK_FALSE(reference.target_heading_rad());
}

TEST_CASE("a path without a heading wants none, on its way and ahead") {
  control::PathReference reference(geometry::Path::square(0.02), {});
  reference.target(1.0, {0.01, -0.01});
  CHECK_FALSE(reference.target_heading_rad());
  CHECK_FALSE(reference.ahead(1.0, 0.5, 1).front().heading_rad);
}

TEST_CASE("a closed path is followed as often as asked") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  config.laps = 3;
  CHECK(control::PathReference(geometry::Path::square(0.02), config).duration_s() == Approx(24.0));
}
