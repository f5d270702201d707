#include "lodestone/vision/segmenter.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "lodestone/common/error.h"
#include "lodestone/nets/checkpoint.h"
#include "temporary_folder.h"
#include "vision/small_segmenter.h"

using namespace lodestone;

TEST_CASE("a segmenter survives its checkpoint, and another kind is refused") {
  const tests::TemporaryFolder folder;
  const vision::TrainSegmenterConfig config = tests::small_config();
  const auto network = tests::untrained_network();
  vision::save_segmenter(folder / "s", config.segmenter, *network, common::config_to_json(config), {});
  const auto loaded = vision::Segmenter::load(folder / "s");
  const cv::Mat image(128, 160, CV_8UC3, cv::Scalar(90, 120, 150));
  const vision::Segmenter direct(config.segmenter, *network);
  CHECK(cv::norm(loaded->segment(image).needle, direct.segment(image).needle, cv::NORM_INF) == 0.0);
  nets::Checkpoint other;
  other.kind = "policy";
  nets::save_checkpoint(folder / "p", other);
  CHECK_THROWS_AS(vision::Segmenter::load(folder / "p"), common::CheckpointError);
}

TEST_CASE("mask pixels lie where the view pixels that they cover lie") {
  const vision::SegmenterConfig config = tests::small_config().segmenter;
  const vision::Segmenter segmenter(config, *tests::untrained_network());
  const imaging::DishView view =
      segmenter.view_of(imaging::CameraModel{}, tests::paper_bench().dish_radius_m);
  const vision::MaskGrid grid = segmenter.grid_of(view, cv::Rect(16, 32, 64, 64));
  // The network takes 4 x 4 pixels together and gives 2 x 2 for them: a mask pixel is two view pixels wide.
  CHECK(grid.pixel_m == Approx(2.0 * view.pixel_m()));
  const geometry::Vector2 corner = 0.5 * (view.to_dish(16, 32) + view.to_dish(17, 33));
  CHECK((grid.first_m - corner).norm() < 1e-9);
  CHECK((grid.at(3, 5) - 0.5 * (view.to_dish(22, 42) + view.to_dish(23, 43))).norm() < 1e-9);
}

TEST_CASE("a sealed segmenter that its tensors do not fill, or that divides by nothing, is refused") {
  const tests::TemporaryFolder folder;
  const auto fault_of = [&](const auto& spoil) {
    const vision::TrainSegmenterConfig config = tests::small_config();
    vision::save_segmenter(folder / "s", config.segmenter, *tests::untrained_network(), {}, {});
    nets::Checkpoint checkpoint = nets::load_checkpoint(folder / "s", "segmenter");
    spoil(checkpoint);
    nets::save_checkpoint(folder / "s", checkpoint);
    try {
      vision::Segmenter::load(folder / "s");
    } catch (const common::CheckpointError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(fault_of([](nets::Checkpoint& c) {
               c.facts["segmenter"]["network"] = {{"width", 256}, {"depth", 6}};
             }),
             Catch::Contains("larger than its tensors"));  // it would take 10 GB
  CHECK_THAT(fault_of([](nets::Checkpoint& c) { c.parts["network"]["colour_std"].zero_(); }),
             Catch::Contains("colour_std"));
  CHECK_THAT(fault_of([](nets::Checkpoint& c) { c.parts["network"]["head.bias"].fill_(NAN); }),
             Catch::Contains("head.bias") && Catch::Contains("finite"));
}
