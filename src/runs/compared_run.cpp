#include "lodestone/runs/compared_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/rigs_result.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using common::ConfigError;

struct Asked {
  std::string folder;
  std::string controller;  ///< empty: none was named
};

Asked asked_for(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (fs::is_directory(text) || colon == std::string::npos || colon == 0) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// The folder itself, or the deployment in it.
std::string deployment_in(const std::string& folder) {
  if (!fs::is_directory(folder)) throw ConfigError("compare: there is no folder " + folder);
  const std::string inner = folder + "/deploy";
  return fs::exists(inner + "/" + DeploymentSummary::kFile) ? inner : folder;
}

std::vector<TrialRecord> trials_in(const std::string& folder) {
  std::vector<TrialRecord> trials;
  const std::optional<RunState> state = find_run(folder);
  bool found = false;
  for (const char* kind : {"", "/explored", "/unseen"}) {
    std::optional<std::vector<TrialRecord>> part = find_trials(folder + kind);
    if (!part) continue;
    found = true;
    std::move(part->begin(), part->end(), std::back_inserter(trials));
  }
  if (state ? !state->finished : !found && fs::exists(folder + "/trials.jsonl"))
    throw common::DataError(folder +
                            ": its trials have not all been driven; the same command with --resume "
                            "goes on where it was");
  if (!found)
    throw ConfigError("compare: " + folder + " holds no " + kTrialsFile +
                      "; name the --out of deploy or of bench rigs");
  if (trials.empty()) throw common::DataError(folder + ": holds no trial");
  return trials;
}

std::int64_t trials_per_rig(const std::string& folder, const common::Json& config) {
  if (fs::exists(folder + "/" + RigsResult::kFile))
    return common::read_artefact<RigsSummary>(folder + "/" + RigsSummary::kFile).trials_per_rig;
  const common::Json::json_pointer key("/trials/per_rig");
  return config.contains(key) && config[key].is_number_integer() ? config[key].get<std::int64_t>() : 0;
}

std::string choose(const Asked& asked, const std::vector<TrialRecord>& trials) {
  std::set<std::string> drove;
  for (const TrialRecord& trial : trials) drove.insert(trial.controller);
  const std::string all = fmt::format("{}", fmt::join(drove, ", "));
  if (!asked.controller.empty()) {
    if (drove.count(asked.controller) == 0)
      throw ConfigError("compare: \"" + asked.controller + "\" did not drive in " + asked.folder +
                        "; there are " + all);
    return asked.controller;
  }
  if (drove.size() > 1) drove.erase("baseline");
  if (drove.size() > 1)
    throw ConfigError("compare: several controllers drove in " + asked.folder +
                      "; name one: " + asked.folder + ":" + *drove.begin() + " (there are " + all + ")");
  return *drove.begin();
}

}  // namespace

ComparedRun read_compared_run(const std::string& text) {
  const Asked asked = asked_for(text);
  ComparedRun run;
  run.name = text;
  run.folder = deployment_in(asked.folder);
  run.config = common::read_json_if_there(run.folder + "/config.json");
  run.trials = trials_in(run.folder);
  run.per_rig = trials_per_rig(run.folder, run.config);
  run.controller = choose(asked, run.trials);
  run.trials.erase(std::remove_if(run.trials.begin(), run.trials.end(),
                                  [&](const auto& trial) { return trial.controller != run.controller; }),
                   run.trials.end());
  return run;
}

}  // namespace lodestone::runs
