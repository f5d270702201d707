#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// A recorded position where nothing can be.
struct ImpossiblePosition {
  std::int64_t line = 0;  ///< of the file
  double radius_m = 0.0;  ///< from the centre
};

/// Moves every transition that begins or ends further than `limit_m` from the centre into
/// `dataset.impossible`; what is left of an episode becomes episodes of its own. `lines[e][row]` is the line
/// that observation `row` of episode e was read from.
std::vector<ImpossiblePosition> separate_impossible(Dataset& dataset,
                                                    const std::vector<std::vector<std::int64_t>>& lines,
                                                    double limit_m);

}  // namespace lodestone::data
