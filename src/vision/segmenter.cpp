#include "lodestone/vision/segmenter.h"

#include <algorithm>

#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/empty.h>

#include "lodestone/common/error.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/unet.h"

namespace lodestone::vision {

namespace {

constexpr const char* kKind = "segmenter";
constexpr const char* kPart = "network";

cv::Mat to_mat(const at::Tensor& map) {
  const at::Tensor values = map.contiguous();
  return cv::Mat(static_cast<int>(map.size(0)), static_cast<int>(map.size(1)), CV_32F,
                 values.data_ptr<float>())
      .clone();
}

/// Before memory is taken for the network: its widest layer, which is most of it, must be among the tensors.
void check_fills(const nets::UNetConfig& config, const nets::NamedTensors& tensors, const std::string& what) {
  const std::int64_t widest = config.width << config.depth;
  std::int64_t largest = 0;
  for (const auto& [name, tensor] : tensors) largest = std::max(largest, tensor.numel());
  if (largest < 9 * widest * widest)
    throw common::CheckpointError(what + ": a network of width " + std::to_string(config.width) +
                                  " and depth " + std::to_string(config.depth) +
                                  " is larger than its tensors");
}

}  // namespace

Segmenter::Segmenter(const SegmenterConfig& config, const nets::UNet& network)
    : config_(config), network_(network.folded()) {
  for (std::size_t c = 0; c < 3; ++c) {
    const auto index = static_cast<std::int64_t>(c);
    const float spread = network_->colour_std().view(3)[index].item<float>();
    gain_[c] = 1.0F / spread;
    offset_[c] = -network_->colour_mean().view(3)[index].item<float>() / spread;
  }
}

std::shared_ptr<const Segmenter> Segmenter::load(const std::string& folder) {
  const nets::Checkpoint checkpoint = nets::load_checkpoint(folder, kKind);
  const std::string what = "checkpoint " + folder;
  try {
    const auto config =
        common::config_from_json<SegmenterConfig>(checkpoint.facts.at("segmenter"), what + ", segmenter");
    const nets::NamedTensors& tensors = checkpoint.parts.at(kPart);
    check_fills(config.network, tensors, what);
    nets::UNet network(config.network);
    network.tensors().load(tensors, what);
    if (!(network.colour_std() > 0.0).all().item<bool>())
      throw common::CheckpointError(what + ": tensor \"colour_std\" holds a spread that is not above 0");
    return std::make_shared<const Segmenter>(config, network);
  } catch (const common::Json::exception& error) {
    throw common::CheckpointError(what + ": facts are malformed: " + error.what());
  } catch (const std::out_of_range&) {
    throw common::CheckpointError(what + ": the network is missing");
  }
}

/// LibTorch's broadcasting over three interleaved colours is slow; this is a single pass.
void Segmenter::normalise(const cv::Mat& view, float* out) const {
  const std::size_t count = 3 * view.total();
  const unsigned char* in = view.data;
  for (std::size_t i = 0; i < count; i += 3)
    for (std::size_t c = 0; c < 3; ++c) out[i + c] = static_cast<float>(in[i + c]) * gain_[c] + offset_[c];
}

Evidence Segmenter::segment(const cv::Mat& view) const {
  LODESTONE_CHECK(view.type() == CV_8UC3 && view.isContinuous(), "a view of 8-bit BGR");
  const at::NoGradGuard no_grad;
  // Rows of BGR pixels are what LibTorch calls channels last.
  const at::Tensor pixels = at::empty({1, view.rows, view.cols, 3}, at::kFloat);
  normalise(view, pixels.data_ptr<float>());
  const at::Tensor logits = network_->forward_normalised(pixels.permute({0, 3, 1, 2}));
  return {to_mat(logits[0][0]), to_mat(logits[0][1])};
}

imaging::DishView Segmenter::view_of(const imaging::CameraModel& camera, double dish_radius_m) const {
  return {camera, dish_radius_m, config_.view_margin_m, config_.view_pixel_m, config_.network.multiple()};
}

MaskGrid Segmenter::grid_of(const imaging::DishView& view, const cv::Rect& area) const {
  // A mask pixel covers this many view pixels; its centre is in their middle.
  const double covers =
      static_cast<double>(config_.network.stem) / static_cast<double>(config_.network.upscale);
  const double offset = 0.5 * (covers - 1.0);
  return {view.to_dish(area.x + offset, area.y + offset), covers * view.pixel_m()};
}

void save_segmenter(const std::string& folder, const SegmenterConfig& config, const nets::UNet& network,
                    const common::Json& training, const common::Json& metrics) {
  nets::Checkpoint checkpoint;
  checkpoint.kind = kKind;
  checkpoint.config = training;
  checkpoint.facts["segmenter"] = common::config_to_json(config);
  checkpoint.facts["metrics"] = metrics;
  checkpoint.parts[kPart] = network.tensors().named();
  nets::save_checkpoint(folder, checkpoint);
}

}  // namespace lodestone::vision
