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
