#pragma once

#include <cstdint>

#include <ATen/core/Tensor.h>

#include "lodestone/common/thread_pool.h"
#include "lodestone/imaging/scene.h"
#include "lodestone/segmentation/sample_config.h"
#include "lodestone/vision/segmenter.h"

namespace lodestone::segmentation {

/// Rectified crops and their true masks.
struct SegmenterSamples {
  at::Tensor images;  ///< [N, 3, crop, crop] uint8 BGR
  at::Tensor masks;   ///< [N, 2, m, m] uint8: fraction of each mask pixel that is needle, tape; 255 is all

  std::int64_t size() const { return images.size(0); }
};

/// `count` samples; each scene has random streams of its own, so that the result does not depend on threads.
SegmenterSamples render_samples(const imaging::SceneConfig& scenes, const SampleConfig& config,
                                const vision::SegmenterConfig& segmenter, std::int64_t count,
                                std::uint64_t seed, common::ThreadPool& pool);

}  // namespace lodestone::segmentation
