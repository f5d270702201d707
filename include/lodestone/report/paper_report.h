#pragma once

#include <string>

#include "lodestone/runs/kept_results.h"

namespace lodestone::report {

/// Writes report.html, report.json (runs::PaperResult), table.md and images/ into `folder`: each table and
/// figure of the paper's section V beside ours, of what is there; what is not is drawn as missing. A scale
/// below the full one is named above its tables. Paces are those of experiments::paper_pace_plan(). Returns
/// the tables as text for a terminal. Throws IoError.
std::string write_paper_report(const runs::KeptPlan& kept, const runs::KeptPlan& paces,
                               const std::string& folder);

}  // namespace lodestone::report
