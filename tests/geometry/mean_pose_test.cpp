#include "lodestone/geometry/mean_pose.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/geometry/angle.h"

using namespace lodestone;
using geometry::mean_pose;

TEST_CASE("headings are averaged across the cut of the circle, places as they are", "[unit]") {
  const geometry::Pose2 mean = mean_pose({{0.01, 0.0, 3.0}, {0.03, -0.02, -3.0}});
  CHECK(mean.x_m == Approx(0.02));
  CHECK(mean.y_m == Approx(-0.01));
  CHECK(std::abs(mean.heading_rad) == Approx(geometry::kPi));
  const geometry::Pose2 one = mean_pose({{0.01, 0.02, -0.4}});
  CHECK(one.heading_rad == Approx(-0.4));
}
