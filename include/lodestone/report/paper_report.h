#pragma once

#include <string>

namespace lodestone::report {

/// Reads what `lodestone bench paper` ran into `folder` and writes report.html, report.json and table.md
/// beside it:
///
///   cells/policy/ROW/{centre,target,pose}/SEED    result.json, metrics.jsonl
///   cells/mix/{0,1,2,3,offline}/SEED              result.json, metrics.jsonl
///   cells/transfer/ROW/TASK/SEED                  summary.json, trials.json
///   cells/ablation/NAME/{point,square}/SEED       summary.json, trials.json
///
/// Parts that are missing are left out. Errors are pooled over training seeds; intervals are 95 %: stratified
/// bootstrap of the interquartile mean with the seeds as strata, Wilson's for success. `scale` is named in
/// the report. Returns the tables as text for a terminal. Throws DataError and IoError.
std::string write_paper_report(const std::string& folder, const std::string& scale);

}  // namespace lodestone::report
