#pragma once

#include <optional>
#include <string>

#include "lodestone/report/run_data.h"

namespace lodestone::report {

/// The whole page. `recorded` is a run on real recordings to set beside it.
std::string report_html(const RunData& run, const std::optional<RunData>& recorded);

/// Reads the run folders and writes the page to `out`, and `summary.json` and `table.txt` into `run_folder`.
/// `recorded_folder` may be empty. Throws ConfigError, DataError and IoError.
void write_report(const std::string& run_folder, const std::string& recorded_folder, const std::string& out);

}  // namespace lodestone::report
