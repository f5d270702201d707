#include "lodestone/control/reference.h"

#include <catch2/catch.hpp>

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

TEST_CASE("a closed path is followed as often as asked") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  config.laps = 3;
  CHECK(control::PathReference(geometry::Path::square(0.02), config).duration_s() == Approx(24.0));
}
