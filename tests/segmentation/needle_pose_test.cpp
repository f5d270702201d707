#include "lodestone/segmentation/needle_pose.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "paper_scenes.h"
#include "sphere_rig.h"

using namespace lodestone;

TEST_CASE("a needle that is drawn lies inside the dish with both ends") {
  const imaging::BenchGeometry bench = tests::paper_bench();
  common::RandomStream random(1, "poses");
  double farthest_m = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const geometry::Pose2 pose = segmentation::draw_needle_pose(bench, random);
    const geometry::Vector2 half = 0.5 * bench.needle_length_m *
                                   geometry::Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
    for (const double end : {-1.0, 1.0})
      farthest_m = std::max(farthest_m, (pose.position_m() + end * half).norm());
  }
  CHECK(farthest_m < bench.dish_radius_m - 0.5 * bench.needle_diameter_m);
  CHECK(farthest_m > 0.95 * bench.dish_radius_m);  // and everywhere in it
}

TEST_CASE("a sphere that is drawn lies inside the dish, and has no heading") {
  const imaging::BenchGeometry bench = rig::bench_of(tests::sphere_rig());
  common::RandomStream random(1, "poses");
  for (int i = 0; i < 1000; ++i) {
    const geometry::Pose2 pose = segmentation::draw_needle_pose(bench, random);
    CHECK(pose.heading_rad == 0.0);
    CHECK(pose.position_m().norm() < bench.dish_radius_m - 0.5 * bench.needle_diameter_m);
  }
}
