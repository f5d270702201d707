#include "lodestone/vision/segmenter.h"

#include "lodestone/common/error.h"
#include "lodestone/inference/checkpoint.h"

namespace lodestone::vision {

namespace {

constexpr const char* kPart = "network";

}  // namespace

Segmenter::Segmenter(const SegmenterConfig& config, const inference::Arrays& weights, const std::string& what)
    : config_(config), network_(config.network, weights, what) {}

std::shared_ptr<const Segmenter> Segmenter::load(const std::string& folder) {
  const inference::Checkpoint checkpoint = inference::load_checkpoint(folder, kKind);
  const std::string what = "checkpoint " + folder;
  const auto part = checkpoint.parts.find(kPart);
  if (part == checkpoint.parts.end() || !checkpoint.facts.contains("segmenter"))
    throw common::CheckpointError(what + ": holds no network, or not its shape");
  const auto config =
      common::config_from_json<SegmenterConfig>(checkpoint.facts.at("segmenter"), what + ", segmenter");
  return std::make_shared<const Segmenter>(config, part->second, what);
}

Evidence Segmenter::segment(const cv::Mat& view, Workspace& workspace) const {
  LODESTONE_CHECK(view.type() == CV_8UC3 && view.isContinuous(), "a view of 8-bit BGR");
  const inference::UNetConfig& network = config_.network;
  const auto height = static_cast<int>(view.rows * network.upscale / network.stem);
  const auto width = static_cast<int>(view.cols * network.upscale / network.stem);
  cv::Mat logits(inference::UNetConfig::kClasses * height, width, CV_32F);
  network_.forward(view.data, view.rows, view.cols, logits.ptr<float>(), workspace);
  return {logits.rowRange(0, height), logits.rowRange(height, 2 * height)};
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

void save_segmenter(const std::string& folder, const SegmenterConfig& config,
                    const inference::Arrays& weights, const common::Json& training,
                    const common::Json& metrics) {
  inference::Checkpoint checkpoint;
  checkpoint.kind = Segmenter::kKind;
  checkpoint.config = training;
  checkpoint.facts["segmenter"] = common::config_to_json(config);
  checkpoint.facts["metrics"] = metrics;
  checkpoint.parts[kPart] = weights;
  inference::save_checkpoint(folder, checkpoint);
}

}  // namespace lodestone::vision
