#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/experiments/bounded_figure.h"

namespace lodestone::apps {

/// Prints a line for each figure from the `first` on.
void print_bounds(const std::vector<experiments::BoundedFigure>& figures, std::size_t first = 0);

/// Throws HardwareError, naming the first, where bounds are broken; `verb` begins the message.
void check_bounds(const std::string& verb, const std::vector<experiments::BoundedFigure>& figures);

}  // namespace lodestone::apps
