#include "lodestone/runs/deployment_results.h"

#include <fmt/core.h>

#include <filesystem>
#include <fstream>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

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

namespace {

/// As somebody else may have written it.
std::vector<TrialRecord> trials_of(const common::Json& json, const std::string& path) {
  if (!json.is_array()) throw common::DataError(path + ": must be a list of trials; run deploy again");
  std::vector<TrialRecord> trials;
  for (const common::Json& trial : json)
    trials.push_back(common::artefact_from_json<TrialRecord>(trial, path));
  return trials;
}

}  // namespace

std::optional<std::vector<TrialRecord>> find_trials(const std::string& folder) {
  const std::string path = folder + "/" + kTrialsFile;
  if (!std::filesystem::exists(path)) return std::nullopt;
  common::check_is_file(path);
  std::ifstream lines(path);
  std::string line;
  const auto a_trial = [](const std::string& text) { return text.size() > 1 && text.front() == '{'; };
  if (!std::getline(lines, line) || line != "[" || !std::getline(lines, line) || !a_trial(line))
    return trials_of(common::read_json_if_there(path), path);
  // As deploy writes it, a trial a line: no number of them is too large to be read.
  std::vector<TrialRecord> trials;
  const auto damaged = [&](const std::string& what) {
    return common::DataError(path + ": " + what + "; the file is damaged: run the step that writes it again");
  };
  do {
    if (line == "]") return trials;
    if (!line.empty() && line.back() == ',') line.pop_back();
    try {
      trials.push_back(common::artefact_from_json<TrialRecord>(common::parse_json(line, path), path));
    } catch (const common::DataError& error) {
      throw damaged(fmt::format("trial {} of the file: {}", trials.size(), error.what()));
    }
  } while (std::getline(lines, line));
  throw damaged("it ends in the middle");
}

}  // namespace lodestone::runs
