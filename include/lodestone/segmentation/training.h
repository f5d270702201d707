#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/imaging/scene.h"
#include "lodestone/inference/array.h"
#include "lodestone/runs/run_folder.h"
#include "lodestone/runs/training_results.h"
#include "lodestone/segmentation/frames_config.h"
#include "lodestone/segmentation/label_proposals.h"
#include "lodestone/segmentation/sample_config.h"
#include "lodestone/vision/segmenter.h"

namespace lodestone::segmentation {

/// How the network learns.
struct SegmenterTrainingConfig {
  std::int64_t samples = 4000;
  std::int64_t validation_samples = 400;
  std::int64_t evaluation_samples = 200;
  std::int64_t epochs = 30;
  std::int64_t batch_size = 32;
  double learning_rate = 3e-3;
  double weight_decay = 1e-4;
  double cross_entropy = 20.0;
  double dice = 1.0;
  double brightness_jitter = 0.15;
  std::int64_t patience = 8;
  double max_seconds = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("samples", samples, "", "rendered training images", {8, 1000000});
    v.field("validation_samples", validation_samples, "", "rendered images to choose weights by",
            {1, 100000});
    v.field("evaluation_samples", evaluation_samples, "", "rendered images to measure the result by",
            {1, 100000});
    v.field("epochs", epochs, "", "passes over the training images", {1, 10000});
    v.field("batch_size", batch_size, "images", "images per step; a multiple of 4", {4, 4096});
    v.field("learning_rate", learning_rate, "", "largest step size of AdamW; falls along half a cosine",
            {1e-7, 1.0});
    v.field("weight_decay", weight_decay, "", "decoupled weight decay", {0.0, 1.0});
    v.field("cross_entropy", cross_entropy, "", "weight of the cross-entropy of all pixels", {0.0, 1e4});
    v.field("dice", dice, "", "weight of the Dice losses of needle and tape", {0.0, 1e4});
    v.field("brightness_jitter", brightness_jitter, "",
            "augmentation: gain of each colour, drawn for each image at each use", {0.0, 0.9});
    v.field("patience", patience, "epochs", "stop after so long without a better validation loss; 0: never",
            {0, 10000});
    v.field("max_seconds", max_seconds, "s",
            "stop after this wall time (the result then depends on the machine); 0: never", {0.0, 1e7});
  }
};

/// Everything `lodestone train-segmenter` is told.
struct TrainSegmenterConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  vision::SegmenterConfig segmenter;
  SampleConfig images;
  imaging::SceneConfig scenes;
  FramesConfig frames;
  SegmenterTrainingConfig training;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of every random stream of the run", {0, 9e15});
    v.field("threads", threads, "", "threads; 0 means one per processor", {0, 1024});
    v.group("segmenter", segmenter, "what is trained");
    v.group("images", images, "what the images hold");
    v.group("scenes", scenes, "benches, lights and cameras the images are drawn from");
    v.group("frames", frames, "images of a needle of your own, to learn from as well");
    v.group("training", training, "how it learns");
  }
  /// Throws ConfigError when sizes do not fit the network.
  void validate() const;
};

struct SegmenterTrainingResult {
  inference::Arrays weights;     ///< of the U-Net by name: the best of all epochs
  runs::TrainingFacts facts;     ///< validation_loss: of the weights that were kept; time with rendering
  double validation_dice = 0.0;  ///< overlap of predicted and true needle, 1 is perfect
};

/// Where a training begins, and what it learns from besides rendered images.
struct FrameTraining {
  inference::Arrays weights;  ///< of the U-Net by name
  FrameViews frames;
  FrameLabels labels;                          ///< of these frames
  std::vector<std::size_t> train, validation;  ///< frames to learn from, and to choose weights by
};

/// The run of a configuration, and which of its keys may change when it is gone on with.
runs::RunRequest run_request(const TrainSegmenterConfig& config, const std::string& folder, bool resume);

/// Trains the U-Net on rendered images: cross-entropy plus Dice (Milletari et al., 2016), AdamW, flips and
/// quarter turns and colour gains as augmentation. Each batch is cut into four fixed shards with a batch
/// normalisation of their own, so that the result depends on the seed and not on threads. Writes metrics,
/// TensorBoard images of predictions and, after every epoch, `training` into the run's folder, from which a
/// resumption goes on bitwise. Throws ConfigError, CheckpointError, IoError, and Interrupted after saving.
/// With `frames`, goes on from their weights and normaliser.
SegmenterTrainingResult train_segmenter(const TrainSegmenterConfig& config, runs::RunFolder& run,
                                        const FrameTraining* frames = nullptr);

}  // namespace lodestone::segmentation
