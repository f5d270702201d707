#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lodestone/imaging/bench.h"
#include "lodestone/segmentation/label_proposals.h"
#include "lodestone/segmentation/sample_config.h"
#include "lodestone/segmentation/samples.h"

namespace lodestone::segmentation {

/// Crops of labelled images, `crops` of each, around the needle or (SampleConfig::elsewhere) anywhere, with
/// the masks that a needle of the bench's size has where the label says. The same seed always gives the same.
SegmenterSamples frame_samples(const FrameViews& frames, const FrameLabels& labels,
                               const std::vector<std::size_t>& which, const imaging::BenchGeometry& bench,
                               const SampleConfig& config, const vision::SegmenterConfig& segmenter,
                               std::int64_t crops, std::uint64_t seed);

}  // namespace lodestone::segmentation
