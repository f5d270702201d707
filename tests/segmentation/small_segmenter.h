#pragma once

#include "lodestone/segmentation/training.h"
#include "paper_scenes.h"
#include "unet_weights.h"

namespace lodestone::tests {

/// As small as a training can be.
inline segmentation::TrainSegmenterConfig small_config() {
  segmentation::TrainSegmenterConfig config;
  config.scenes = paper_scenes();
  config.segmenter.network = small_unet();
  config.images.crop_px = 128;
  config.images.frames_per_scene = 8;
  config.training.samples = 16;
  config.training.validation_samples = 8;
  config.training.batch_size = 8;
  config.training.epochs = 2;
  config.threads = 1;
  return config;
}

/// Weights of a network that has learned nothing.
inline inference::Arrays untrained_weights() { return drawn_unet_weights(small_unet(), 1); }

}  // namespace lodestone::tests
