#include "lodestone/safety/fence_check.h"

#include <limits>

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("a needle beyond the fence, or nowhere, is not trusted") {
  safety::FenceCheck check(0.06);
  control::PoseEstimate estimate;
  estimate.pose = {0.0, 0.06, 0.0};
  check.observe(estimate, 0.0);
  estimate.pose = {0.061, 0.0, 0.0};
  CHECK_THROWS_WITH(check.observe(estimate, 0.0),
                    Catch::Contains("61 mm from the dish centre") && Catch::Contains("60 mm"));
  estimate.pose.x_m = 0.0595;
  check.observe(estimate, 0.0);
  estimate.position_sigma_m = 1e-3;  // it may lie further out
  CHECK_THROWS_AS(check.observe(estimate, 0.0), safety::Distrust);
  estimate.position_sigma_m = 0.0;
  estimate.pose.x_m = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(check.observe(estimate, 0.0), safety::Distrust);
}
