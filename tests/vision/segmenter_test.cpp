#include "lodestone/vision/segmenter.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "lodestone/common/error.h"
#include "lodestone/inference/checkpoint.h"
#include "paper_scenes.h"
#include "temporary_folder.h"
#include "unet_weights.h"

using namespace lodestone;

namespace {

vision::SegmenterConfig small_segmenter() {
  vision::SegmenterConfig config;
  config.network = tests::small_unet();
  return config;
}

inference::Arrays drawn_weights() { return tests::drawn_unet_weights(tests::small_unet(), 1); }

}  // namespace

TEST_CASE("a segmenter survives its checkpoint, and another kind is refused") {
  const tests::TemporaryFolder folder;
  vision::save_segmenter(folder / "s", small_segmenter(), drawn_weights(), {}, {});
  const auto loaded = vision::Segmenter::load(folder / "s");
  const cv::Mat image(128, 160, CV_8UC3, cv::Scalar(90, 120, 150));
  const vision::Segmenter direct(small_segmenter(), drawn_weights());
  vision::Segmenter::Workspace workspace;
  const vision::Evidence seen = loaded->segment(image, workspace);
  CHECK(seen.needle.size() == cv::Size(80, 64));
  CHECK(cv::norm(seen.needle, direct.segment(image, workspace).needle, cv::NORM_INF) == 0.0);
  CHECK(cv::norm(seen.tape, direct.segment(image, workspace).tape, cv::NORM_INF) == 0.0);
  CHECK(cv::norm(seen.tape, seen.needle, cv::NORM_INF) > 0.0);
  inference::Checkpoint other;
  other.kind = "policy";
  inference::save_checkpoint(folder / "p", other);
  CHECK_THROWS_AS(vision::Segmenter::load(folder / "p"), common::CheckpointError);
}

TEST_CASE("mask pixels lie where the view pixels that they cover lie") {
  const vision::Segmenter segmenter(small_segmenter(), drawn_weights());
  const imaging::DishView view =
      segmenter.view_of(imaging::CameraModel{}, tests::paper_bench().dish_radius_m);
  const vision::MaskGrid grid = segmenter.grid_of(view, cv::Rect(16, 32, 64, 64));
  // The network takes 4 x 4 pixels together and gives 2 x 2 for them: a mask pixel is two view pixels wide.
  CHECK(grid.pixel_m == Approx(2.0 * view.pixel_m()));
  const geometry::Vector2 corner = 0.5 * (view.to_dish(16, 32) + view.to_dish(17, 33));
  CHECK((grid.first_m - corner).norm() < 1e-9);
  CHECK((grid.at(3, 5) - 0.5 * (view.to_dish(22, 42) + view.to_dish(23, 43))).norm() < 1e-9);
}

TEST_CASE("a sealed segmenter whose tensors are not those of its network is refused") {
  const tests::TemporaryFolder folder;
  const auto fault_of = [&](const auto& spoil) {
    vision::save_segmenter(folder / "s", small_segmenter(), drawn_weights(), {}, {});
    inference::Checkpoint checkpoint = inference::load_checkpoint(folder / "s", "segmenter");
    spoil(checkpoint);
    inference::save_checkpoint(folder / "s", checkpoint);
    try {
      vision::Segmenter::load(folder / "s");
    } catch (const common::CheckpointError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(fault_of([](inference::Checkpoint& c) {
               c.facts["segmenter"]["network"] = {{"width", 256}, {"depth", 6}};
             }),
             Catch::Contains((folder / "s") + ": array \"stem.weight\""));
  CHECK_THAT(fault_of([](inference::Checkpoint& c) { c.parts.clear(); }),
             Catch::Contains("holds no network"));
  CHECK_THAT(fault_of([](inference::Checkpoint& c) { c.facts.erase("segmenter"); }),
             Catch::Contains("holds no network, or not its shape"));
}
