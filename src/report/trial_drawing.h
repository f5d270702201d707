#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/report/dish_svg.h"
#include "trial_data.h"

namespace lodestone::report {

/// More lines than these hide one another.
constexpr std::size_t kDrawnTrials = 16;

/// Colour of a controller's lines, the same on every image.
std::string colour_of(const std::string& controller);

/// Trajectories of the first trials, seen from above, with starts, ends, and targets or the path; empty
/// without trials. Obstacles that a trial has of its own are drawn where it is the only one. `label`
/// describes it to those who cannot see it.
std::string draw_trials(const std::vector<const Trial*>& trials, const DrawnRig& rig,
                        const std::string& label);

/// A drawing as a file of its own, for READMEs and papers. Throws IoError.
void write_svg(const std::string& path, const std::string& drawing);

/// What such drawings show, for their caption: only what is in these trials.
std::string legend_of(const std::vector<const Trial*>& trials);

}  // namespace lodestone::report
