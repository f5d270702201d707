#include "lodestone/segmentation/samples.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "segmentation/small_segmenter.h"

using namespace lodestone;

TEST_CASE("samples hold a needle and its mask, and do not depend on threads") {
  const segmentation::TrainSegmenterConfig config = tests::small_config();
  common::ThreadPool one(1);
  common::ThreadPool three(3);
  const auto a = segmentation::render_samples(config.scenes, config.images, config.segmenter, 24, 5, one);
  const auto b = segmentation::render_samples(config.scenes, config.images, config.segmenter, 24, 5, three);
  CHECK(at::equal(a.images, b.images));
  CHECK(at::equal(a.masks, b.masks));
  CHECK(a.masks.sizes() == at::IntArrayRef({24, 2, 64, 64}));
  // Tape is part of the needle, and most images show one.
  CHECK((a.masks.select(1, 1) > a.masks.select(1, 0)).sum().item<int>() < 20);
  CHECK((a.masks.select(1, 0).flatten(1).sum(1) > 0).sum().item<int>() > 12);
}

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
