#pragma once

#include <cstdint>

#include <torch/torch.h>

#include "lodestone/common/thread_pool.h"
#include "lodestone/imaging/scene.h"
#include "lodestone/vision/segmenter.h"

namespace lodestone::vision {

/// What the rendered training images hold.
struct SampleConfig {
  std::int64_t frames_per_scene = 12;
  std::int64_t crop_px = 256;
  double elsewhere = 0.1;
  double none = 0.05;
  double two = 0.06;
  double covered = 0.45;
  double max_covered = 0.45;
  double moving = 0.1;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("frames_per_scene", frames_per_scene, "", "images of one scene", {1, 10000});
    v.field("crop_px", crop_px, "px", "side of a training image, in pixels of the view", {32, 4096});
    v.field("elsewhere", elsewhere, "", "fraction of images cut anywhere in the dish, not around the needle",
            {0.0, 1.0});
    v.field("none", none, "", "fraction of images without a needle", {0.0, 1.0});
    v.field("two", two, "", "fraction of images with two needles", {0.0, 1.0});
    v.field("covered", covered, "", "fraction of needles that are partly covered", {0.0, 1.0});
    v.field("max_covered", max_covered, "", "largest covered fraction of a needle", {0.0, 1.0});
    v.field("moving", moving, "", "fraction of needles that move during the exposure", {0.0, 1.0});
  }
};

/// Rectified crops and their true masks.
struct SegmenterSamples {
  torch::Tensor images;  ///< [N, 3, crop, crop] uint8 BGR
  torch::Tensor masks;   ///< [N, 2, m, m] uint8: fraction of each mask pixel that is needle, tape; 255 is all

  std::int64_t size() const { return images.size(0); }
};

/// A pose with the whole needle inside the dish, uniform over the disc and over headings.
geometry::Pose2 draw_needle_pose(const imaging::BenchGeometry& bench, common::RandomStream& random);

/// `count` samples; each scene has random streams of its own, so that the result does not depend on threads.
SegmenterSamples render_samples(const imaging::SceneConfig& scenes, const SampleConfig& config,
                                const SegmenterConfig& segmenter, std::int64_t count, std::uint64_t seed,
                                common::ThreadPool& pool);

}  // namespace lodestone::vision
