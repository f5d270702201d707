#include "lodestone/segmentation/frame_samples.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <ATen/ops/empty.h>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/segmentation/needle_pose.h"
#include "sample_rows.h"

namespace lodestone::segmentation {
namespace {

/// Coverage of each pixel of a view by a part of a needle: from one place along it to its head end.
cv::Mat rod_mask(const imaging::DishView& view, const geometry::Pose2& pose, double from_m, double to_m,
                 double radius_m) {
  cv::Mat mask = cv::Mat::zeros(view.size_px(), view.size_px(), CV_8U);
  const geometry::Vector2 along(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  const geometry::Vector2 across(-along.y(), along.x());
  const double middle_m = 0.5 * (from_m + to_m), half_m = 0.5 * (to_m - from_m);
  for (int row = 0; row < mask.rows; ++row) {
    auto* out = mask.ptr<unsigned char>(row);
    for (int column = 0; column < mask.cols; ++column) {
      const geometry::Vector2 offset_m = view.to_dish(column, row) - pose.position_m();
      const double inside_s_m = half_m - std::abs(along.dot(offset_m) - middle_m);
      const double inside_d_m = radius_m - std::abs(across.dot(offset_m));
      const double coverage = std::clamp(0.5 + inside_s_m / view.pixel_m(), 0.0, 1.0) *
                              std::clamp(0.5 + inside_d_m / view.pixel_m(), 0.0, 1.0);
      out[column] = static_cast<unsigned char>(std::lround(255.0 * coverage));
    }
  }
  return mask;
}

/// The same of a sphere.
cv::Mat disc_mask(const imaging::DishView& view, const geometry::Vector2& middle_m, double radius_m) {
  cv::Mat mask = cv::Mat::zeros(view.size_px(), view.size_px(), CV_8U);
  for (int row = 0; row < mask.rows; ++row) {
    auto* out = mask.ptr<unsigned char>(row);
    for (int column = 0; column < mask.cols; ++column) {
      const double inside_m = radius_m - (view.to_dish(column, row) - middle_m).norm();
      out[column] = static_cast<unsigned char>(
          std::lround(255.0 * std::clamp(0.5 + inside_m / view.pixel_m(), 0.0, 1.0)));
    }
  }
  return mask;
}

}  // namespace

SegmenterSamples frame_samples(const FrameViews& frames, const FrameLabels& labels,
                               const std::vector<std::size_t>& which, const imaging::BenchGeometry& bench,
                               const SampleConfig& config, const vision::SegmenterConfig& segmenter,
                               std::int64_t crops, std::uint64_t seed) {
  const inference::UNetConfig& network = segmenter.network;
  const std::int64_t side_px = config.crop_px;
  if (side_px > frames.view.size_px())
    throw common::ConfigError("images.crop_px = " + std::to_string(side_px) + " must be at most " +
                              std::to_string(frames.view.size_px()) + ", the side of a view of this dish");
  const std::int64_t count = static_cast<std::int64_t>(which.size()) * crops;
  const std::int64_t mask_px = side_px * network.upscale / network.stem;
  SegmenterSamples samples;
  samples.images = at::empty({count, 3, side_px, side_px}, at::kByte);
  samples.masks = at::empty({count, 2, mask_px, mask_px}, at::kByte);
  std::int64_t row = 0;
  for (const std::size_t index : which) {
    common::RandomStream random(seed, "crops of a frame", index);
    const std::optional<LabelledPose>& pose = labels.labels[index].pose;
    const double half_m = 0.5 * bench.needle_length_m, radius_m = 0.5 * bench.needle_diameter_m;
    cv::Mat needle = cv::Mat::zeros(frames.view.size_px(), frames.view.size_px(), CV_8U);
    cv::Mat tape = needle.clone();
    if (pose)
      needle = bench.sphere ? disc_mask(frames.view, pose->position_m(), radius_m)
                            : rod_mask(frames.view, *pose, -half_m, half_m, radius_m);
    if (pose && labels.taped)
      tape = rod_mask(frames.view, *pose, half_m - bench.tape_length_m, half_m, radius_m);
    for (std::int64_t crop = 0; crop < crops; ++crop, ++row) {
      geometry::Vector2 centre_m = draw_needle_pose(bench, random).position_m();
      if (pose && random.uniform() >= config.elsewhere) {
        const double room_m = std::max(
            0.0, 0.5 * static_cast<double>(side_px) * frames.view.pixel_m() - 0.25 * bench.needle_length_m);
        centre_m = pose->position_m() +
                   geometry::Vector2(random.uniform(-room_m, room_m), random.uniform(-room_m, room_m));
      }
      const cv::Rect area = frames.view.around(centre_m, static_cast<int>(side_px));
      store_image(frames.images[index](area), row, samples);
      store_mask(needle(area), row, 0, samples);
      store_mask(tape(area), row, 1, samples);
    }
  }
  return samples;
}

}  // namespace lodestone::segmentation
