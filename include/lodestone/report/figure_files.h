#pragma once

#include <string>
#include <vector>

namespace lodestone::report {

/// Saves every figure of a page that this program wrote (`report`, `compare`, `sweep`, `bench`, `import`)
/// into `folder`, for one column of a journal (85 mm) and for two (175 mm): NAME.csv, NAME-85mm.svg,
/// NAME-85mm.pdf, NAME-175mm.svg and NAME-175mm.pdf; and charts.gp, from which gnuplot made the charts.
/// Numbers are those that the page draws. Returns the names. Throws ConfigError where the page holds no
/// figure, or gnuplot or rsvg-convert is not installed (the CSV files are written before), DataError where a
/// chart is damaged, and IoError.
std::vector<std::string> save_figures(const std::string& page, const std::string& folder);

}  // namespace lodestone::report
