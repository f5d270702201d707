#include "lodestone/physics/obstacles.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/polygon.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

constexpr double kThin_m = 0.5e-3;  // radius of the capsules

ObstacleConfig disc(double x_m, double y_m, double radius_m) {
  ObstacleConfig config;
  config.centre_m = {x_m, y_m};
  config.radius_m = radius_m;
  return config;
}

ObstacleConfig polygon(std::vector<double> corners_m) {
  ObstacleConfig config;
  config.shape = ObstacleShape::kPolygon;
  config.corners_m = std::move(corners_m);
  return config;
}

/// 4 mm by 2 mm, its lower left corner at (10, 0) mm.
ObstacleConfig block() { return polygon({0.01, 0.0, 0.014, 0.0, 0.014, 0.002, 0.01, 0.002}); }

std::vector<Obstacles::Touch> touches_of(const ObstacleConfig& config, const Vector2& tail_m,
                                         const Vector2& head_m, double within_m) {
  std::vector<Obstacles::Touch> touches;
  Obstacles({config}).find({tail_m, head_m, kThin_m}, within_m, touches);
  return touches;
}

TEST_CASE("a disc is touched where the axis comes nearest to its middle") {
  const auto touches = touches_of(disc(0.02, 0.004, 2e-3), {0.01, 0.0}, {0.03, 0.0}, 2e-3);
  REQUIRE(touches.size() == 1);
  CHECK((touches[0].at_m - Vector2(0.02, 0.0)).norm() < 1e-15);
  CHECK((touches[0].towards - Vector2(0.0, 1.0)).norm() < 1e-12);
  CHECK(touches[0].clearance_m == Approx(1.5e-3));
  CHECK(touches_of(disc(0.02, 0.004, 2e-3), {0.01, 0.0}, {0.03, 0.0}, 1e-3).empty());
  const auto ahead = touches_of(disc(0.034, 0.003, 2e-3), {0.01, 0.0}, {0.03, 0.0}, 3e-3);
  REQUIRE(ahead.size() == 1);
  CHECK((ahead[0].at_m - Vector2(0.03, 0.0)).norm() < 1e-15);
  CHECK((ahead[0].towards - Vector2(0.8, 0.6)).norm() < 1e-12);
  CHECK(ahead[0].clearance_m == Approx(2.5e-3));
}

TEST_CASE("a needle along a side touches at both ends, or at both corners where the side is shorter") {
  for (const bool turned : {false, true}) {
    const ObstacleConfig shape =
        turned ? polygon({0.01, 0.002, 0.014, 0.002, 0.014, 0.0, 0.01, 0.0}) : block();  // clockwise
    const auto within = touches_of(shape, {0.011, -1e-3}, {0.013, -1e-3}, 1e-3);
    REQUIRE(within.size() == 2);
    const auto over = touches_of(shape, {0.0, -1e-3}, {0.03, -1e-3}, 1e-3);
    REQUIRE(over.size() == 2);
    for (const auto* both : {&within, &over}) {
      for (const Obstacles::Touch& touch : *both) {
        CHECK((touch.towards - Vector2(0.0, 1.0)).norm() < 1e-12);
        CHECK(touch.clearance_m == Approx(0.5e-3));
      }
    }
    CHECK(std::abs(over[0].at_m.x() - over[1].at_m.x()) == Approx(4e-3));
  }
}

TEST_CASE("an end before a corner touches the corner, one in a notch both of its sides") {
  const auto corner = touches_of(block(), {0.0, -4e-3}, {0.007, -4e-3}, 0.01);
  REQUIRE(corner.size() == 1);
  CHECK((corner[0].towards - Vector2(0.6, 0.8)).norm() < 1e-12);
  CHECK(corner[0].clearance_m == Approx(4.5e-3));
  // A right angle that opens towards +y, its bottom at (0, 10) mm.
  const ObstacleConfig notched = polygon({-0.01, 0.0, 0.01, 0.0, 0.01, 0.02, 0.0, 0.01, -0.01, 0.02});
  const auto notch = touches_of(notched, {0.0, 0.012}, {0.0, 0.03}, 1.2e-3);
  REQUIRE(notch.size() == 2);
  for (const Obstacles::Touch& touch : notch) {
    CHECK((touch.at_m - Vector2(0.0, 0.012)).norm() < 1e-15);
    CHECK(touch.towards.y() == Approx(-std::sqrt(0.5)));
    CHECK(touch.clearance_m == Approx(2e-3 * std::sqrt(0.5) - kThin_m));
  }
}

TEST_CASE("the clearance of any capsule is that to the nearest of many points of the outline") {
  const std::vector<ObstacleConfig> shapes = {
      disc(0.005, -0.004, 3e-3), block(),
      polygon({-0.01, 0.0, 0.01, 0.0, 0.01, 0.02, 0.0, 0.01, -0.01, 0.02})};
  int near = 0, overlapping = 0;
  for (const ObstacleConfig& shape : shapes) {
    const std::vector<Vector2> outline = shape.outline_m();
    for (int i = 0; i < 400; ++i) {
      // Places and directions that fill the square evenly, in no order.
      const Vector2 middle(0.05 * (std::fmod(0.618034 * i, 1.0) - 0.5),
                           0.05 * (std::fmod(0.754878 * i, 1.0) - 0.5));
      const Vector2 arm = 4e-3 * Vector2(std::cos(1.7 * i), std::sin(1.7 * i));
      const Capsule capsule{middle - arm, middle + arm, kThin_m};
      double distance_m = 1.0;
      bool inside = geometry::inside_polygon(outline, middle);
      for (std::size_t k = 0; k < outline.size(); ++k) {
        for (int part = 0; part < 200; ++part) {
          const Vector2 point = outline[k] + part / 200.0 * (outline[(k + 1) % outline.size()] - outline[k]);
          const double along = std::clamp((point - middle).dot(arm) / arm.squaredNorm(), -1.0, 1.0);
          distance_m = std::min(distance_m, (middle + along * arm - point).norm());
        }
      }
      const Obstacles obstacles({shape});
      const double clearance_m = distance_m - kThin_m;
      CAPTURE(i, clearance_m);
      if (inside || clearance_m < -1e-4) {
        ++overlapping;
        CHECK_FALSE(obstacles.clear_of(capsule));
      } else if (clearance_m > 1e-4) {
        CHECK(obstacles.clear_of(capsule));
        std::vector<Obstacles::Touch> touches;
        obstacles.find(capsule, 2e-3, touches);
        double least_m = 1.0;
        for (const Obstacles::Touch& touch : touches) least_m = std::min(least_m, touch.clearance_m);
        if (clearance_m < 1.9e-3) {
          ++near;
          CHECK(least_m == Approx(clearance_m).margin(5e-5));
        }
      }
    }
  }
  CHECK(near > 15);
  CHECK(overlapping > 30);
}

TEST_CASE("an axis that passes through a body is seen to") {
  const Obstacles obstacles({disc(0.0, 0.0, 2e-3), block()});
  CHECK(obstacles.on_axis({{-0.01, 0.0}, {0.005, 0.0}, kThin_m}));  // through the disc's very middle
  CHECK(obstacles.on_axis({{0.009, 0.001}, {0.02, 0.001}, kThin_m}));
  CHECK(obstacles.on_axis({{0.011, 0.001}, {0.012, 0.001}, kThin_m}));  // wholly inside
  CHECK_FALSE(obstacles.on_axis({{-0.01, 0.0025}, {0.02, 0.0025}, kThin_m}));
  CHECK_FALSE(obstacles.clear_of({{-0.01, 0.0022}, {0.02, 0.0022}, kThin_m}));  // reaches in with its side
  CHECK(obstacles.clear_of({{-0.01, 0.0026}, {0.02, 0.0026}, kThin_m}));
  CHECK(Obstacles().empty());
  CHECK(Obstacles().clear_of({{0.0, 0.0}, {0.0, 0.0}, kThin_m}));
}

TEST_CASE("an obstacle reaches as far as its outline") {
  CHECK(disc(0.03, 0.04, 1e-3).reach_m() == Approx(0.051));
  CHECK(block().reach_m() == Approx(std::hypot(0.014, 0.002)));
  CHECK(block().outline_m().size() == 4);
  for (const Vector2& point : disc(0.01, 0.0, 2e-3).outline_m())
    CHECK((point - Vector2(0.01, 0.0)).norm() == Approx(2e-3));
}

TEST_CASE("what is no obstacle is refused, and what is comes back as it was written") {
  const auto read = [](const char* json) {
    return common::config_from_json<ObstacleConfig>(common::Json::parse(json), "test");
  };
  CHECK_THROWS_WITH(read(R"({"shape": "polygon", "corners_m": [0.0, 0.0, 0.01, 0.0]})"),
                    Catch::Contains("3 to 1000 corners"));
  CHECK_THROWS_WITH(read(R"({"shape": "polygon", "corners_m": [0.0, 0.0, 0.01, 0.0, 0.01, 0.01, 0.0]})"),
                    Catch::Contains("3 to 1000 corners"));
  CHECK_THROWS_WITH(
      read(R"({"shape": "polygon", "corners_m": [0.0, 0.0, 0.01, 0.01, 0.01, 0.0, 0.0, 0.01]})"),
      Catch::Contains("crosses or touches another"));
  CHECK_THROWS_WITH(read(R"({"radius_m": -0.002})"), Catch::Contains("radius_m = -0.002"));
  CHECK_THROWS_WITH(read(R"({"centre_m": [0.0, 0.0, 0.0]})"), Catch::Contains("must hold [x, y]"));
  CHECK_THROWS_WITH(read(R"({"corners_m": [0.0, 0.0, 0.01, 0.0, 0.0, 0.01]})"),
                    Catch::Contains("where shape is disc"));
  CHECK_THROWS_AS(Obstacles({polygon({0.0, 0.0, 0.01, 0.0})}), common::ConfigError);
  for (const ObstacleConfig& config : {disc(0.01, 0.0, 3e-3), block()}) {
    const common::Json written = common::config_to_json(config);
    CHECK(common::config_to_json(common::config_from_json<ObstacleConfig>(written, "test")) == written);
  }
}

}  // namespace
}  // namespace lodestone::physics
