#include "lodestone/segmentation/frame_samples.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/common/error.h"
#include "segmentation/own_frames.h"
#include "segmentation/small_segmenter.h"
#include "sphere_rig.h"

using namespace lodestone;

TEST_CASE("crops of labelled images hold the needle where the label says, as large as it is") {
  const tests::OwnFrames own = tests::own_frames(10);
  const segmentation::TrainSegmenterConfig config = tests::small_config();
  segmentation::FrameLabels labels = segmentation::propose_labels(own.frames, own.bench);
  labels.labels[2] = {labels.labels[2].frame, std::nullopt, "hidden", 1.0, false};
  labels.labels[5] = {labels.labels[5].frame, std::nullopt, std::nullopt, 1.0, true};
  const std::vector<std::size_t> which = segmentation::usable(labels, 0, 8);
  CHECK(std::find(which.begin(), which.end(), 2) == which.end());
  CHECK(std::find(which.begin(), which.end(), 5) != which.end());

  segmentation::SampleConfig around = config.images;
  around.elsewhere = 0.0;
  around.crop_px = 256;
  const std::vector<std::size_t> one = {0};
  REQUIRE(labels.labels[0].pose);
  const auto samples =
      segmentation::frame_samples(own.frames, labels, one, own.bench, around, config.segmenter, 6, 3);
  CHECK(samples.size() == 6);
  const double pixel_m = 0.4e-3;  // of the mask: two of the view
  for (std::int64_t row = 0; row < 6; ++row) {
    const double needle_m2 = samples.masks[row][0].sum().item<double>() / 255.0 * pixel_m * pixel_m;
    const double tape_m2 = samples.masks[row][1].sum().item<double>() / 255.0 * pixel_m * pixel_m;
    const double whole_m2 = own.bench.needle_length_m * own.bench.needle_diameter_m;
    CHECK(needle_m2 < 1.1 * whole_m2);
    CHECK(needle_m2 > 0.4 * whole_m2);  // some of it may be cut off
    CHECK(tape_m2 < 1.2 * own.bench.tape_length_m * own.bench.needle_diameter_m);
  }
  const auto again =
      segmentation::frame_samples(own.frames, labels, one, own.bench, around, config.segmenter, 6, 3);
  CHECK(at::equal(samples.images, again.images));
  // A person says that there is none.
  const auto none =
      segmentation::frame_samples(own.frames, labels, {5}, own.bench, around, config.segmenter, 2, 3);
  CHECK(none.masks.sum().item<double>() == 0.0);
  // A sphere is a disc.
  imaging::BenchGeometry round = rig::bench_of(tests::sphere_rig());
  segmentation::FrameLabels of_sphere = labels;
  of_sphere.taped = false;
  of_sphere.labels[0].pose->x_m = of_sphere.labels[0].pose->y_m = 0.0;
  const auto discs =
      segmentation::frame_samples(own.frames, of_sphere, one, round, around, config.segmenter, 6, 3);
  double largest_m2 = 0.0;
  for (std::int64_t row = 0; row < 6; ++row)
    largest_m2 = std::max(largest_m2, discs.masks[row][0].sum().item<double>() / 255.0 * pixel_m * pixel_m);
  CHECK(largest_m2 == Approx(3.14159265 * 1.5e-3 * 1.5e-3).epsilon(0.05));
  around.crop_px = 1024;
  CHECK_THROWS_WITH(
      segmentation::frame_samples(own.frames, labels, one, own.bench, around, config.segmenter, 1, 3),
      Catch::Contains("images.crop_px = 1024 must be at most"));
}
