#include "lodestone/vision/segmenter_training.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <opencv2/core.hpp>

#include <torch/types.h>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/unet.h"
#include "lodestone/vision/segmenter_evaluation.h"
#include "lodestone/vision/segmenter_samples.h"
#include "paper_scenes.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

vision::TrainSegmenterConfig small_config() {
  vision::TrainSegmenterConfig config;
  config.scenes = tests::paper_scenes();
  config.segmenter.network.width = 4;
  config.segmenter.network.depth = 2;
  config.images.crop_px = 128;
  config.images.frames_per_scene = 8;
  config.training.samples = 16;
  config.training.validation_samples = 8;
  config.training.batch_size = 8;
  config.training.epochs = 2;
  config.threads = 1;
  return config;
}

std::string weights(const std::shared_ptr<nets::UNetImpl>& network) {
  return common::sha256(inference::encode_safetensors(nets::to_arrays(nets::module_tensors(*network))));
}

}  // namespace

TEST_CASE("samples hold a needle and its mask, and do not depend on threads") {
  const vision::TrainSegmenterConfig config = small_config();
  common::ThreadPool one(1);
  common::ThreadPool three(3);
  const auto a = vision::render_samples(config.scenes, config.images, config.segmenter, 24, 5, one);
  const auto b = vision::render_samples(config.scenes, config.images, config.segmenter, 24, 5, three);
  CHECK(torch::equal(a.images, b.images));
  CHECK(torch::equal(a.masks, b.masks));
  CHECK(a.masks.sizes() == torch::IntArrayRef({24, 2, 64, 64}));
  // Tape is part of the needle, and most images show one.
  CHECK((a.masks.select(1, 1) > a.masks.select(1, 0)).sum().item<int>() < 20);
  CHECK((a.masks.select(1, 0).flatten(1).sum(1) > 0).sum().item<int>() > 12);
}

TEST_CASE("training depends on the seed, not on threads, and resumes bitwise", "[slow]") {
  const tests::TemporaryFolder folder;
  vision::TrainSegmenterConfig config = small_config();
  const auto train = [&](const std::string& name, std::int64_t threads, std::int64_t epochs, bool resume) {
    config.threads = threads;
    config.training.epochs = epochs;
    runs::RunFolder run(vision::run_request(config, folder / name, resume));
    auto result = vision::train_segmenter(config, run);
    return weights(result.network);
  };
  const std::string straight = train("a", 1, 2, false);
  CHECK(train("b", 2, 2, false) == straight);
  CHECK(std::filesystem::exists(folder / "a/predictions.png"));
  config.training.max_seconds = 1e-9;  // stops after the first epoch
  CHECK(train("c", 2, 2, false) != straight);
  config.training.max_seconds = 0.0;
  CHECK(train("c", 1, 2, true) == straight);
  config.training.learning_rate *= 2.0;
  CHECK_THROWS_AS(train("c", 1, 2, true), common::ConfigError);
}

TEST_CASE("sizes that do not fit the network are named") {
  vision::TrainSegmenterConfig config = small_config();
  config.images.crop_px = 100;
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("crop_px"));
  config = small_config();
  config.training.batch_size = 6;
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("batch_size"));
}

TEST_CASE("a segmenter survives its checkpoint, and another kind is refused") {
  const tests::TemporaryFolder folder;
  const vision::TrainSegmenterConfig config = small_config();
  const auto network = std::make_shared<nets::UNetImpl>(config.segmenter.network);
  common::RandomStream random(1, "weights");
  network->initialise(random);
  network->eval();
  vision::save_segmenter(folder / "s", config.segmenter, network, common::config_to_json(config), {});
  const auto loaded = vision::Segmenter::load(folder / "s");
  const cv::Mat image(128, 160, CV_8UC3, cv::Scalar(90, 120, 150));
  const vision::Segmenter direct(config.segmenter, network);
  CHECK(cv::norm(loaded->segment(image).needle, direct.segment(image).needle, cv::NORM_INF) == 0.0);
  CHECK(vision::training_scenes(folder / "s").glare.high == config.scenes.glare.high);
  nets::Checkpoint other;
  other.kind = "policy";
  nets::save_checkpoint(folder / "p", other);
  CHECK_THROWS_AS(vision::Segmenter::load(folder / "p"), common::CheckpointError);
}

TEST_CASE("where no pose was found there is no error, and the words say so") {
  const vision::TrainSegmenterConfig config = small_config();
  nets::UNet network(config.segmenter.network);
  common::RandomStream random(1, "weights");
  network->initialise(random);
  network->eval();
  vision::LocaliserConfig localiser;
  localiser.rod = vision::rod_of(config.scenes.bench);
  common::ThreadPool pool(1);
  const vision::SegmenterEvaluation evaluation =
      vision::evaluate_segmenter(std::make_shared<const vision::Segmenter>(config.segmenter, network.ptr()),
                                 config.scenes, localiser, 2, 1, pool);
  REQUIRE(evaluation.clean.poses == 0);  // nothing was learned
  CHECK_FALSE(evaluation.clean.position_rms_mm);
  CHECK_FALSE(evaluation.repeatability_mm);
  const common::Json json = vision::to_json(evaluation);
  CHECK_FALSE(json.at("clean").contains("position_rms_mm"));
  CHECK_FALSE(json.at("clean").contains("ms_per_frame"));
  CHECK_FALSE(json.contains("repeatability_mm"));
  CHECK(json.at("clean").at("refusals").size() > 0);
  CHECK_THAT(vision::in_words(evaluation), Catch::Contains("clean no pose found; "));
}
