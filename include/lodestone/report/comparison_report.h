#pragma once

#include <string>

#include "lodestone/runs/comparison.h"

namespace lodestone::report {

/// Writes the page `out`: what can be said, the figures with their intervals, every trial's error in one run
/// against that in the other, and what the runs were told otherwise. Returns the sentences and the table as
/// text for a terminal. Throws IoError.
std::string write_comparison_report(const runs::Comparison& comparison, const std::string& out);

}  // namespace lodestone::report
