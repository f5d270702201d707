#pragma once

#include <string>

#include "lodestone/runs/sweep.h"

namespace lodestone::report {

/// Writes what came of a sweep as `folder`/report.html: its table, and a picture: of one numeric key a curve
/// with its interval, else bars, best first. Returns the table as text for a terminal. Throws IoError.
std::string write_sweep_report(const runs::SweepResult& result, const std::string& folder);

}  // namespace lodestone::report
