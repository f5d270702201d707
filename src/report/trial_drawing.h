#pragma once

#include <cstddef>
#include <string>

#include "lodestone/common/config.h"

namespace lodestone::report {

/// More lines than these hide one another.
constexpr std::size_t kDrawnTrials = 16;

/// True trajectories of the first trials of a task by one controller ("policy" or "baseline"), seen from
/// above, out of trials.json; empty when it holds none.
std::string draw_trials(const common::Json& trials, const std::string& task, const std::string& controller,
                        double radius_mm);

}  // namespace lodestone::report
