#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/runs/deployment_results.h"

namespace lodestone::report {

/// More lines than these hide one another.
constexpr std::size_t kDrawnTrials = 16;

/// Trajectories of the first trials of a task by one controller, seen from above: true ones, or as sensed
/// where nobody knows those; empty when there are none.
std::string draw_trials(const std::vector<runs::TrialRecord>& trials, const std::string& task,
                        const std::string& controller, double radius_mm);

/// A drawing as a file of its own, for READMEs and papers. Throws IoError.
void write_svg(const std::string& path, const std::string& drawing);

}  // namespace lodestone::report
