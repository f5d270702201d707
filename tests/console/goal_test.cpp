#include "lodestone/console/goal.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "sphere_rig.h"

using namespace lodestone;

TEST_CASE("a goal along a path has the headings that are configured") {
  experiments::DeploymentConfig config;
  const console::Goal plain = console::path_goal(geometry::Path::square(0.02), config);
  CHECK(plain.task == "path");
  CHECK(plain.stitches.empty());
  CHECK_FALSE(plain.path->heading_rad(0.0));
  config.trials.path_heading = geometry::HeadingRule::kFixed;
  config.trials.path_heading_deg = 90.0;
  CHECK(*console::path_goal(geometry::Path::square(0.02), config).path->heading_rad(0.0) ==
        Approx(0.5 * geometry::kPi));
}

TEST_CASE("a suture leads through its stitches, along a path that shows how the needle shall lie") {
  experiments::DeploymentConfig config;
  config.trials.suture.count = 2;
  const console::Goal goal = console::suture_goal(config);
  CHECK(goal.task == "suture");
  CHECK(goal.stitches.size() == 2);
  REQUIRE(goal.path);
  // 6 mm through each and 6 mm on, and from there back to the next one, 4 mm beside the first.
  CHECK(goal.path->length_m() == Approx(0.012 + std::hypot(0.004, 0.006) + 0.012));
  CHECK(*goal.path->heading_rad(0.0) == Approx(0.5 * geometry::kPi));
  config.trials.suture.length_m = 0.07;
  CHECK_THROWS_WITH(console::suture_goal(config), Catch::Contains("wall of the dish"));
  config = {};
  config.rig.needle = tests::sphere();
  CHECK_THROWS_WITH(console::suture_goal(config), Catch::Contains("a sphere"));
}
