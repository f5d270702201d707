#include "lodestone/segmentation/training.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/binary_cross_entropy_with_logits.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/sigmoid.h>
#include <ATen/ops/stack.h>
#include <ATen/ops/tensor.h>
#include <ATen/ops/zeros.h>
#include <ATen/ops/zeros_like.h>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/imaging/image_file.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/optimiser.h"
#include "lodestone/nets/unet.h"
#include "lodestone/runs/curves.h"
#include "lodestone/runs/resumable_run.h"
#include "lodestone/segmentation/frame_samples.h"
#include "lodestone/segmentation/samples.h"
#include "prediction_image.h"

namespace lodestone::segmentation {

void TrainSegmenterConfig::validate() const {
  const inference::UNetConfig& network = segmenter.network;
  if (images.crop_px % network.multiple() != 0)
    throw common::InvalidConfig("images.crop_px", images.crop_px,
                                "be a multiple of " + std::to_string(network.multiple()) +
                                    " (segmenter.network.stem times 2 to the power of its depth)");
  if (training.batch_size % 4 != 0)
    throw common::InvalidConfig("training.batch_size", training.batch_size, "be a multiple of 4");
  if (training.samples < training.batch_size)
    throw common::InvalidConfig("training.samples", training.samples,
                                "be at least training.batch_size = " + std::to_string(training.batch_size));
}

namespace {

using at::Tensor;
using common::Json;

constexpr const char* kTrainingKind = "segmenter_training";
constexpr std::size_t kShards = 4;  ///< fixed, so that results do not depend on threads

/// Of probabilities and targets [N, C, H, W]: 1 is perfect overlap; per class, over the batch.
Tensor dice(const Tensor& probability, const Tensor& target) {
  const std::vector<std::int64_t> all = {0, 2, 3};
  return (2.0 * (probability * target).sum(all) + 1.0) /
         ((probability * probability).sum(all) + (target * target).sum(all) + 1.0);
}

Tensor loss_of(const SegmenterTrainingConfig& config, const Tensor& logits, const Tensor& target) {
  const Tensor cross_entropy = at::binary_cross_entropy_with_logits(logits, target);
  return config.cross_entropy * cross_entropy +
         config.dice * (1.0 - dice(at::sigmoid(logits), target).mean());
}

/// One of the eight ways to lay a square on itself.
Tensor turned(const Tensor& image, std::uint64_t way) {
  Tensor out = image;
  if ((way & 1U) != 0) out = out.flip(-1);
  if ((way & 2U) != 0) out = out.flip(-2);
  if ((way & 4U) != 0) out = out.transpose(-1, -2);
  return out;
}

class Training : public runs::ResumableWork {
 public:
  Training(const TrainSegmenterConfig& config, std::string folder, const FrameTraining* frames)
      : config_(config),
        folder_(std::move(folder)),
        seed_(static_cast<std::uint64_t>(config.seed)),
        pool_(static_cast<std::size_t>(config.threads)) {
    start_s_ = clock_.now_s();
    if (frames != nullptr) {  // first, as they may be refused
      train_ = cut(*frames, frames->train);
      validation_ = cut(*frames, frames->validation);
    }
    add(render(config.training.samples, "train"), train_);
    add(render(config.training.validation_samples, "validation"), validation_);
    common::log_info("there are " + std::to_string(train_.size() + validation_.size()) + " images");
    for (std::size_t shard = 0; shard < kShards; ++shard) {
      networks_.push_back(std::make_shared<nets::UNet>(config.segmenter.network));
      networks_.back()->tensors().flatten();
    }
    common::RandomStream random(seed_, "segmenter weights");
    networks_[0]->initialise(random);
    if (frames != nullptr)
      networks_[0]->tensors().load(nets::to_tensors(frames->weights), "the segmenter that goes on learning");
    else
      networks_[0]->fit_normaliser(train_.images.slice(0, 0, std::min<std::int64_t>(train_.size(), 256)));
    share();
    first_moment_ = at::zeros_like(networks_[0]->tensors().values());
    second_moment_ = at::zeros_like(networks_[0]->tensors().values());
    best_ = state();
    if (frames != nullptr) validate();  // what it begins with is not given up for worse
  }

  void load(const std::string& folder) override {
    const std::string where = folder + "/training";
    const nets::Checkpoint checkpoint = nets::load_checkpoint(where, kTrainingKind);
    const std::string what = "checkpoint " + where;
    try {
      networks_[0]->tensors().load(checkpoint.parts.at("network"), what);
      best_ = checkpoint.parts.at("best");
      first_moment_.copy_(checkpoint.parts.at("moments").at("first"));
      second_moment_.copy_(checkpoint.parts.at("moments").at("second"));
      epoch_ = checkpoint.facts.at("epoch").get<std::int64_t>();
      stale_epochs_ = checkpoint.facts.at("stale_epochs").get<std::int64_t>();
      best_loss_ = checkpoint.facts.at("best_loss").get<double>();
      best_dice_ = checkpoint.facts.at("best_dice").get<double>();
    } catch (const Json::exception& error) {
      throw common::CheckpointError(what + ": facts are malformed: " + error.what());
    } catch (const std::out_of_range&) {
      throw common::CheckpointError(what + ": a part is missing");
    }
    shared_ = false;  // the other shards' statistics are those of a fresh network
    share();
  }

  void save(const std::string& folder) override {
    nets::Checkpoint checkpoint;
    checkpoint.kind = kTrainingKind;
    checkpoint.config = common::config_to_json(config_);
    checkpoint.facts["epoch"] = epoch_;
    checkpoint.facts["stale_epochs"] = stale_epochs_;
    checkpoint.facts["best_loss"] = best_loss_;
    checkpoint.facts["best_dice"] = best_dice_;
    checkpoint.parts["network"] = networks_[0]->tensors().named();
    checkpoint.parts["best"] = best_;
    checkpoint.parts["moments"] = {{"first", first_moment_}, {"second", second_moment_}};
    nets::save_checkpoint(folder + "/training", checkpoint);
  }

  runs::Progress progress() const override {
    const SegmenterTrainingConfig& training = config_.training;
    const bool enough = training.patience > 0 && stale_epochs_ >= training.patience;
    const bool out_of_time = training.max_seconds > 0.0 && clock_.now_s() - start_s_ > training.max_seconds;
    return {epoch_, training.epochs, epoch_ >= training.epochs || enough || (epoch_ > 0 && out_of_time),
            note()};
  }

  void step(common::MetricsLog& metrics) override {
    run_epoch();
    validate();
    ++epoch_;
    metrics.write(epoch_, {{runs::curves::kTrainLoss, train_loss_},
                           {runs::curves::kValidationLoss, validation_loss_},
                           {"validation_dice_needle", validation_dice_},
                           {"validation_dice_tape", validation_dice_tape_}});
    show(metrics);
  }

  SegmenterTrainingResult finish(double seconds) {
    SegmenterTrainingResult result;
    result.weights = nets::to_arrays(best_);
    result.facts = {best_loss_, train_loss_, epoch_, seconds};
    result.validation_dice = best_dice_;
    return result;
  }

 private:
  SegmenterSamples render(std::int64_t count, const char* part) {
    return render_samples(config_.scenes, config_.images, config_.segmenter, count,
                          common::derive_seed(seed_, part), pool_);
  }

  SegmenterSamples cut(const FrameTraining& frames, const std::vector<std::size_t>& which) const {
    return frame_samples(frames.frames, frames.labels, which, config_.scenes.bench, config_.images,
                         config_.segmenter, config_.frames.crops, seed_);
  }

  static void add(const SegmenterSamples& more, SegmenterSamples& samples) {
    if (!samples.images.defined()) {
      samples = more;
      return;
    }
    samples.images = at::cat({samples.images, more.images});
    samples.masks = at::cat({samples.masks, more.masks});
  }

  std::int64_t batches() const { return train_.size() / config_.training.batch_size; }

  nets::NamedTensors state() const {
    nets::NamedTensors copy;
    for (const auto& [name, tensor] : networks_[0]->tensors().named()) copy[name] = tensor.clone();
    return copy;
  }

  /// Gives every shard the parameters of the first, and the mean of all running statistics.
  void share() {
    const at::NoGradGuard no_grad;
    std::vector<std::vector<Tensor>> buffers;
    for (const auto& network : networks_) buffers.push_back(network->tensors().buffers());
    for (std::size_t i = 0; i < buffers[0].size(); ++i) {
      if (!buffers[0][i].is_floating_point()) continue;
      if (shared_) {
        Tensor sum = buffers[0][i].clone();
        for (std::size_t shard = 1; shard < kShards; ++shard) sum += buffers[shard][i];
        buffers[0][i].copy_(sum / static_cast<double>(kShards));
      }
      for (std::size_t shard = 1; shard < kShards; ++shard) buffers[shard][i].copy_(buffers[0][i]);
    }
    for (std::size_t shard = 1; shard < kShards; ++shard)
      networks_[shard]->tensors().values().copy_(networks_[0]->tensors().values());
    shared_ = true;
  }

  std::vector<std::int64_t> epoch_order() const {
    std::vector<std::int64_t> order(static_cast<std::size_t>(train_.size()));
    std::iota(order.begin(), order.end(), 0);
    common::RandomStream random(seed_, "segmenter order", static_cast<std::uint64_t>(epoch_));
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    return order;
  }

  void run_epoch() {
    const std::vector<std::int64_t> order = epoch_order();
    const auto size = static_cast<std::size_t>(config_.training.batch_size);
    double sum = 0.0;
    for (std::int64_t batch = 0; batch < batches(); ++batch) {
      if (common::interrupted()) throw common::Interrupted("an epoch was left half-done");
      sum += run_batch(order.data() + static_cast<std::size_t>(batch) * size, size / kShards);
      optimiser_step(epoch_ * batches() + batch);
      share();
      train_loss_ = sum / static_cast<double>(batch + 1);
    }
  }

  double run_batch(const std::int64_t* rows, std::size_t per_shard) {
    std::vector<double> losses(kShards);
    pool_.for_each(kShards, [&](std::size_t shard) {
      std::vector<Tensor> images;
      std::vector<Tensor> targets;
      for (std::size_t i = 0; i < per_shard; ++i) augment(rows[shard * per_shard + i], images, targets);
      networks_[shard]->tensors().gradient().zero_();
      networks_[shard]->train(true);
      const Tensor logits =
          networks_[shard]->forward(at::stack(images).contiguous(at::MemoryFormat::ChannelsLast));
      Tensor loss = loss_of(config_.training, logits, at::stack(targets));
      loss.backward();
      losses[shard] = loss.item<double>();
    });
    const double loss = std::accumulate(losses.begin(), losses.end(), 0.0) / static_cast<double>(kShards);
    if (!std::isfinite(loss))
      throw common::Error("training of the segmenter diverged in epoch " + std::to_string(epoch_) +
                          " (its loss is not finite); lower training.learning_rate");
    return loss;
  }

  void augment(std::int64_t row, std::vector<Tensor>& images, std::vector<Tensor>& targets) const {
    common::RandomStream random(seed_, "segmenter augmentation",
                                static_cast<std::uint64_t>(epoch_ * train_.size() + row));
    const std::uint64_t way = random.below(8);
    const double jitter = config_.training.brightness_jitter;
    const double all = random.uniform(1.0 - jitter, 1.0 + jitter);
    std::vector<float> gains;
    for (int i = 0; i < 3; ++i)
      gains.push_back(static_cast<float>(all * random.uniform(1.0 - 0.5 * jitter, 1.0 + 0.5 * jitter)));
    const Tensor gain = at::tensor(gains).view({3, 1, 1});
    images.push_back((turned(train_.images[row], way).to(at::kFloat) * gain).clamp_max(255.0));
    targets.push_back(turned(train_.masks[row], way).to(at::kFloat) / 255.0);
  }

  /// AdamW on the mean of the shards' gradients (Loshchilov and Hutter, 2019), linear warm-up, half a cosine.
  void optimiser_step(std::int64_t step) {
    const at::NoGradGuard no_grad;
    Tensor& gradient = networks_[0]->tensors().gradient();
    for (std::size_t shard = 1; shard < kShards; ++shard) gradient += networks_[shard]->tensors().gradient();
    gradient /= static_cast<double>(kShards);
    const double total = static_cast<double>(config_.training.epochs * batches());
    const double warm_up = std::min(1.0, static_cast<double>(step + 1) / 100.0);
    const double rate = config_.training.learning_rate * warm_up * 0.5 *
                        (1.0 + std::cos(3.14159265358979323846 * static_cast<double>(step) / total));
    Tensor& values = networks_[0]->tensors().values();
    values.mul_(1.0 - rate * config_.training.weight_decay);
    nets::adam_step(values.data_ptr<float>(), gradient.data_ptr<float>(), first_moment_.data_ptr<float>(),
                    second_moment_.data_ptr<float>(), static_cast<std::size_t>(values.numel()), rate,
                    step + 1);
  }

  void validate() {
    constexpr std::int64_t kBatch = 16;
    const std::int64_t count = (validation_.size() + kBatch - 1) / kBatch;
    std::vector<double> losses(static_cast<std::size_t>(count));
    std::vector<Tensor> overlaps(static_cast<std::size_t>(count));
    networks_[0]->train(false);
    pool_.for_each(static_cast<std::size_t>(count), [&](std::size_t batch) {
      const at::NoGradGuard no_grad;
      const std::int64_t first = static_cast<std::int64_t>(batch) * kBatch;
      const std::int64_t last = std::min(first + kBatch, validation_.size());
      const Tensor target = validation_.masks.slice(0, first, last).to(at::kFloat) / 255.0;
      const Tensor logits = networks_[0]->forward(validation_.images.slice(0, first, last).to(at::kFloat));
      losses[batch] =
          loss_of(config_.training, logits, target).item<double>() * static_cast<double>(last - first);
      overlaps[batch] = dice(at::sigmoid(logits), target) * static_cast<double>(last - first);
    });
    const double size = static_cast<double>(validation_.size());
    validation_loss_ = std::accumulate(losses.begin(), losses.end(), 0.0) / size;
    Tensor overlap = at::zeros({2});
    for (const Tensor& part : overlaps) overlap += part;
    validation_dice_ = overlap[0].item<double>() / size;
    validation_dice_tape_ = overlap[1].item<double>() / size;
    ++stale_epochs_;
    if (validation_loss_ < best_loss_) {
      best_loss_ = validation_loss_;
      best_dice_ = validation_dice_;
      best_ = state();
      stale_epochs_ = 0;
    }
  }

  /// Some validation images with the true and the predicted masks, for TensorBoard and as a file.
  void show(common::MetricsLog& metrics) {
    const at::NoGradGuard no_grad;
    const Tensor images = validation_.images.slice(0, 0, std::min<std::int64_t>(validation_.size(), 4));
    const Tensor probability = at::sigmoid(networks_[0]->forward(images.to(at::kFloat)));
    const cv::Mat sheet = prediction_image(images, validation_.masks, probability);
    const std::string png = imaging::encoded_image(sheet, ".png");
    metrics.write_image(epoch_, "predictions", png, sheet.cols, sheet.rows);
    common::write_file_atomically(folder_ + "/predictions.png", png);
  }

  std::string note() const {
    char text[96];
    std::snprintf(text, sizeof text, "loss %.4f, validation %.4f, overlap %.3f", train_loss_,
                  validation_loss_, validation_dice_);
    return text;
  }

  TrainSegmenterConfig config_;
  std::string folder_;
  std::uint64_t seed_;
  common::ThreadPool pool_;
  common::SteadyClock clock_;
  double start_s_ = 0.0;
  SegmenterSamples train_;
  SegmenterSamples validation_;
  std::vector<std::shared_ptr<nets::UNet>> networks_;  ///< one per shard, with the same parameters
  Tensor first_moment_;
  Tensor second_moment_;
  nets::NamedTensors best_;
  bool shared_ = false;
  std::int64_t epoch_ = 0;
  std::int64_t stale_epochs_ = 0;
  double train_loss_ = 0.0;
  double validation_loss_ = 0.0;
  double validation_dice_ = 0.0;
  double validation_dice_tape_ = 0.0;
  double best_loss_ = std::numeric_limits<double>::infinity();
  double best_dice_ = 0.0;
};

}  // namespace

runs::RunRequest run_request(const TrainSegmenterConfig& config, const std::string& folder, bool resume) {
  runs::RunRequest request;
  request.folder = folder;
  request.verb = "train-segmenter";
  request.config = common::config_to_json(config);
  request.seed = config.seed;
  request.resume = resume;
  request.length_keys = {"training.max_seconds"};
  request.inputs = runs::named_inputs(request.config, {"frames.source", "frames.from"});
  return request;
}

SegmenterTrainingResult train_segmenter(const TrainSegmenterConfig& config, runs::RunFolder& run,
                                        const FrameTraining* frames) {
  config.validate();
  Training work(config, run.path(), frames);
  return work.finish(runs::run_resumably(run, work, {"train segmenter", "epochs", 0.0}));
}

}  // namespace lodestone::segmentation
