#include "lodestone/experiments/integrity.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <sstream>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/data/journal.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/runs/deployment_results.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::experiments {
namespace {

namespace fs = std::filesystem;
using common::Json;

constexpr const char* kManifest = "manifest.json";
constexpr const char* kRun = "run.json";
constexpr const char* kTrialLines = "trials.jsonl";

std::string counted(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string size_of(const data::Dataset& dataset) {
  return counted(static_cast<std::size_t>(dataset.transitions()), "transition") + " in " +
         counted(dataset.episodes.size(), "episode");
}

std::string check_recording(const fs::path& file) {
  return "recording, " + size_of(data::read_dataset(file));
}

/// A journal of which nothing is whole yet is no damage: its writer was killed in the first episode.
std::string check_journal(const fs::path& file) {
  const data::JournalContent content = data::read_journal(file);
  std::string what = "unfinished recording, " + size_of({content.info, content.episodes, {}});
  if (content.dropped_bytes > 0) what += ", and part of another";
  return what;
}

std::string check_json(const fs::path& file) {
  common::read_json_if_there(file);
  return "JSON";
}

std::string check_run(const fs::path& file) {
  const auto state = runs::find_run(file.parent_path());
  return "run of " + state->verb + (state->finished ? ", finished" : ", not finished");
}

/// The manifest of a checkpoint names its kind, that of a run does not.
std::string check_manifest(const fs::path& file) {
  const Json manifest = common::read_json_if_there(file);
  if (!manifest.is_object() || !manifest.contains("kind") || !manifest.at("kind").is_string()) return "JSON";
  const auto kind = manifest.at("kind").get<std::string>();
  inference::load_checkpoint(file.parent_path(), kind);
  return "checkpoint, " + kind;
}

std::size_t rows_of(const fs::path& table) {
  const std::string text = fs::exists(table) ? common::read_file(table) : "";
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  return lines == 0 ? 0 : lines - 1;  // without the heading
}

/// Trials that have ended, and their rows. The last line may be cut: its trial is driven again.
std::string check_trials(const fs::path& file) {
  std::istringstream lines(common::read_file(file));
  std::size_t trials = 0;
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line) && !lines.eof(); ++trials) {
    const std::string place = file.string() + ", line " + std::to_string(trials + 1);
    rows +=
        common::artefact_from_json<runs::TrialRecord>(common::parse_json(line, place), place).time_s.size();
  }
  const fs::path table = file.parent_path() / "trajectories.csv";
  if (const std::size_t found = rows_of(table); found < rows)
    throw common::DataError(table.string() + " holds " + std::to_string(found) + " rows, its trials name " +
                            std::to_string(rows) + ": rows are lost; take it from a backup, or drive again");
  return "deployment, " + counted(trials, "trial") + " that ended";
}

using Check = std::function<std::string(const fs::path&)>;

Check check_for(const fs::path& file) {
  const std::string name = file.filename();
  if (name == kManifest) return check_manifest;
  if (name == kRun) return check_run;
  if (name == kTrialLines) return check_trials;
  if (file.extension() == ".journal") return check_journal;
  if (file.extension() == ".h5") return check_recording;
  if (file.extension() == ".json") return check_json;
  return {};
}

/// A folder stands for the checkpoint in it, a file for itself.
std::vector<fs::path> files_at(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<CheckedItem> check_integrity(const std::string& path) {
  if (!fs::exists(path)) throw common::ConfigError("check: " + path + ": there is no such file or folder");
  std::vector<CheckedItem> items;
  for (const fs::path& file : files_at(path)) {
    const Check check = check_for(file);
    if (!check) continue;
    CheckedItem item{file, "", ""};
    try {
      item.what = check(file);
    } catch (const common::Error& error) {
      item.problem = error.what();
    }
    items.push_back(std::move(item));
  }
  if (items.empty())
    throw common::ConfigError(
        "check: " + path +
        " holds nothing that lodestone wrote: name a recording (.h5, .journal), a checkpoint, or "
        "the folder of a run or of several");
  return items;
}

}  // namespace lodestone::experiments
