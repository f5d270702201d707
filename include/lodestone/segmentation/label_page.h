#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/imaging/bench.h"
#include "lodestone/segmentation/label_proposals.h"

namespace lodestone::segmentation {

/// A page, complete in itself, on which a person looks through the labels of some images: flips them, draws
/// them anew by two clicks, or says that there is no needle; it gives labels.json back. `go_on`: the command
/// that comes after, shown on it. Throws IoError.
void write_label_page(const std::string& file, const FrameViews& frames, const FrameLabels& labels,
                      const std::vector<std::size_t>& shown, const imaging::BenchGeometry& bench,
                      const std::string& go_on);

}  // namespace lodestone::segmentation
