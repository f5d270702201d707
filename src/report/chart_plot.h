#pragma once

#include <string>

#include "lodestone/common/config.h"

namespace lodestone::report {

/// A text as gnuplot reads it; line ends become spaces.
std::string gnuplot_text(std::string text);
/// A chart's data as CSV: series, x, y; of bars category, series, y. `spec` is what chart_html() embeds.
std::string chart_csv(const common::Json& spec);
/// Commands by which gnuplot draws the same into the SVG file `out`, so many millimetres wide.
std::string chart_gnuplot(const common::Json& spec, const std::string& out, double width_mm);

}  // namespace lodestone::report
