#include "lodestone/runs/deployment_results.h"

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"

namespace lodestone::runs {

void TrialRecord::validate() const {
  const std::size_t observations = trajectory ? trajectory->size() : sensed_trajectory.size();
  const auto check = [&](const char* name, std::size_t rows) {
    if (rows != observations)
      throw common::DataError("trial " + std::to_string(trial) + ": " + name + " has " +
                              std::to_string(rows) + " rows for " + std::to_string(observations) +
                              " observations");
  };
  if (reference_mm) check("reference_mm", reference_mm->size());
  if (reference_heading_rad) check("reference_heading_rad", reference_heading_rad->size());
  if (approach) check("approach", approach->size());
}

std::optional<std::vector<TrialRecord>> find_trials(const std::string& folder) {
  const std::string path = folder + "/" + kTrialsFile;
  const common::Json json = common::read_json_if_there(path);
  if (json.is_null()) return std::nullopt;
  if (!json.is_array()) throw common::DataError(path + ": must be a list of trials; run deploy again");
  std::vector<TrialRecord> trials;
  for (const common::Json& trial : json)
    trials.push_back(common::artefact_from_json<TrialRecord>(trial, path));
  return trials;
}

}  // namespace lodestone::runs
