#pragma once

#include <memory>

#include "lodestone/nets/unet.h"
#include "lodestone/vision/segmenter_training.h"
#include "paper_scenes.h"

namespace lodestone::tests {

/// As small as a training can be.
inline vision::TrainSegmenterConfig small_config() {
  vision::TrainSegmenterConfig config;
  config.scenes = paper_scenes();
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

/// A network that has learned nothing.
inline std::shared_ptr<nets::UNet> untrained_network() {
  auto network = std::make_shared<nets::UNet>(small_config().segmenter.network);
  common::RandomStream random(1, "weights");
  network->initialise(random);
  network->train(false);
  return network;
}

}  // namespace lodestone::tests
