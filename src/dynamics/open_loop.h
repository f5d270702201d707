#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::dynamics {

/// Next states [N, S] of states [N, S] and actions [N, A].
using Predictor =
    std::function<std::vector<double>(const std::vector<double>& state, const std::vector<double>& action)>;

/// Of states [N, S] against what was recorded, S = 2 or 3.
runs::StateError state_error(const std::vector<double>& predicted, const std::vector<double>& actual,
                             int state_size);

/// Runs a predictor on by itself from every row of a dataset, within its episode; pulses without current move
/// nothing. Of `draws` runs from each row the mean counts (headings on the circle): the rows that a
/// predictor gets are then every place so many times over, one after the other.
runs::OpenLoopError open_loop_error(const Predictor& predictor, const data::Dataset& dataset,
                                    std::int64_t draws = 1);

}  // namespace lodestone::dynamics
