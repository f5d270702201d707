#include "lodestone/segmentation/training.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/inference/checkpoint.h"
#include "segmentation/own_frames.h"
#include "segmentation/small_segmenter.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::small_config;

TEST_CASE("training depends on the seed, not on threads, and resumes bitwise", "[slow]") {
  const tests::TemporaryFolder folder;
  segmentation::TrainSegmenterConfig config = small_config();
  const auto train = [&](const std::string& name, std::int64_t threads, std::int64_t epochs, bool resume) {
    config.threads = threads;
    config.training.epochs = epochs;
    runs::RunFolder run(segmentation::run_request(config, folder / name, resume));
    return common::sha256(inference::encode_safetensors(segmentation::train_segmenter(config, run).weights));
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
  segmentation::TrainSegmenterConfig config = small_config();
  config.images.crop_px = 100;
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("crop_px"));
  config = small_config();
  config.training.batch_size = 6;
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("batch_size"));
}

TEST_CASE("a training with images of one's own goes on from the weights it is given", "[slow]") {
  const tests::TemporaryFolder folder;
  segmentation::TrainSegmenterConfig config = small_config();
  config.frames.crops = 2;
  config.training.learning_rate = 1e-7;  // weights that have learned next to nothing can only become better
  const auto train = [&](const std::string& name, const segmentation::FrameTraining* with, bool resume) {
    runs::RunFolder run(segmentation::run_request(config, folder / name, resume));
    return segmentation::train_segmenter(config, run, with).weights;
  };
  const tests::OwnFrames own = tests::own_frames(8);
  segmentation::FrameTraining frames{
      train("first", nullptr, false), own.frames, {}, {0, 1, 2, 3, 4, 5}, {6, 7}};
  for (std::size_t i = 0; i < own.truth.size(); ++i)
    frames.labels.labels.push_back(
        {own.frames.names[i], segmentation::LabelledPose{own.truth[i]}, std::nullopt, 0.0, true});
  const inference::Arrays same = train("same", &frames, false);
  config.training.learning_rate = 3e-2;
  config.training.epochs = 6;
  const inference::Arrays other = train("other", &frames, false);
  const auto change = [&](const inference::Arrays& weights) {
    const std::vector<double> before = frames.weights.at("stem.weight").to_double();
    const std::vector<double> after = weights.at("stem.weight").to_double();
    double most = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) most = std::max(most, std::abs(after[i] - before[i]));
    return most;
  };
  CHECK(change(same) < 1e-5);
  CHECK(change(other) > 1e-4);
  CHECK(same.at("colour_mean").to_double() == frames.weights.at("colour_mean").to_double());
  const auto seal = [](const inference::Arrays& weights) {
    return common::sha256(inference::encode_safetensors(weights));
  };
  config.training.max_seconds = 1e-9;  // stops after the first epoch
  train("resumed", &frames, false);
  config.training.max_seconds = 0.0;
  CHECK(seal(train("resumed", &frames, true)) == seal(other));
}
