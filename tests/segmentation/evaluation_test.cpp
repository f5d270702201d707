#include "lodestone/segmentation/evaluation.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "segmentation/own_frames.h"
#include "segmentation/small_segmenter.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("where no pose was found there is no error, and the words say so") {
  const segmentation::TrainSegmenterConfig config = tests::small_config();
  vision::LocaliserConfig localiser;
  localiser.rod = vision::rod_of(config.scenes.bench);
  common::ThreadPool pool(1);
  const segmentation::SegmenterEvaluation evaluation = segmentation::evaluate_segmenter(
      std::make_shared<const vision::Segmenter>(config.segmenter, tests::untrained_weights()), config.scenes,
      localiser, 2, 1, pool);
  REQUIRE(evaluation.clean.poses == 0);  // nothing was learned
  CHECK_FALSE(evaluation.clean.position_rms_mm);
  CHECK_FALSE(evaluation.repeatability_mm);
  const common::Json json = common::artefact_to_json(evaluation);
  CHECK_FALSE(json.at("clean").contains("position_rms_mm"));
  CHECK_FALSE(json.at("clean").contains("ms_per_frame"));
  CHECK_FALSE(json.contains("repeatability_mm"));
  CHECK(json.at("clean").at("refusals").size() > 0);
  CHECK_THAT(segmentation::in_words(evaluation), Catch::Contains("clean no pose found; "));
}

TEST_CASE("a checkpoint holds the scenes it was trained on, without the bench") {
  const tests::TemporaryFolder folder;
  segmentation::TrainSegmenterConfig config = tests::small_config();
  config.scenes.glare.high *= 0.5;
  vision::save_segmenter(folder / "s", config.segmenter, tests::untrained_weights(),
                         common::config_to_json(config), {});
  CHECK(segmentation::training_scenes(folder / "s").glare.high == config.scenes.glare.high);
}

TEST_CASE("whole views are scored by the poses they are known to show") {
  const tests::OwnFrames own = tests::own_frames(3);
  const segmentation::TrainSegmenterConfig config = tests::small_config();
  const vision::Segmenter untrained(config.segmenter, tests::untrained_weights());
  const segmentation::LocalisationScore score = segmentation::evaluate_views(
      untrained, own.frames.view, vision::rod_of(own.bench), own.frames.images, own.truth);
  CHECK(score.n == 3);
  CHECK(score.poses == 0);  // nothing was learned
  CHECK(score.refusals.size() > 0);
}
