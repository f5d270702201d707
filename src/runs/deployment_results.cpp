#include "lodestone/runs/deployment_results.h"

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"

namespace lodestone::runs {

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
