#include "lodestone/experiments/task_file.h"

#include <algorithm>
#include <filesystem>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/spelling.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::experiments {
namespace {

using common::ConfigError;
using common::Json;

/// What is handed on as it is.
struct HandedOn {
  const char* key;
  const char* sets;
};
constexpr HandedOn kHandedOn[] = {
    {"target_mm", "target_mm"},           {"flow", "flow"},
    {"side_m", "trials.square_side_m"},   {"radius_m", "trials.circle_radius_m"},
    {"speed_m_s", "reference.speed_m_s"}, {"laps", "reference.laps"},
    {"seconds", "trials.point_seconds"},  {"length_m", "trials.suture.length_m"},
    {"pitch_m", "trials.suture.pitch_m"},
};

std::string setting(const char* key, const Json& value) { return std::string(key) + "=" + value.dump(); }

void check_keys(const std::string& file, const Json& json) {
  if (!json.is_object())
    throw ConfigError(file + ": a task is a JSON object {\"task\": ...}, not " + common::shown_json(json));
  std::vector<std::string> known = {"task", "path", "heading", "stitches"};
  for (const HandedOn& each : kHandedOn) known.emplace_back(each.key);
  for (const auto& [key, value] : json.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw ConfigError(file + ": unknown key " + common::shown(key) + " = " + common::shown_json(value) +
                        "; " + common::spelling_hint(key, known, "known keys"));
}

std::string task_of(const std::string& file, const Json& json) {
  const std::vector<std::string> tasks(runs::kTasks.begin(), runs::kTasks.end());
  const auto found = json.find("task");
  if (found == json.end()) throw ConfigError(file + ": task is missing: one of " + common::joined(tasks));
  if (!found->is_string() || std::find(tasks.begin(), tasks.end(), found->get<std::string>()) == tasks.end())
    throw ConfigError(file + ": task = " + common::shown_json(*found) + " must be one of " +
                      common::joined(tasks));
  return found->get<std::string>();
}

/// A stitch has headings of its own, and nothing else has stitches.
void check_suture_keys(const std::string& file, const Json& json, const std::string& task) {
  const char* const wrong = task == "suture" ? "heading" : "stitches";
  const auto found = json.find(wrong);
  if (found == json.end()) return;
  throw ConfigError(file + ": " + wrong + " = " + common::shown_json(*found) +
                    (task == "suture"
                         ? " is not for the task \"suture\": its stitches have entry_deg and exit_deg"
                         : " belongs to the task \"suture\", not to \"" + task + "\""));
}

/// What `stitches` sets: a list of them, or how many there are in a row.
std::vector<std::string> stitches_settings(const std::string& file, const Json& stitches) {
  if (stitches.is_number())
    return {setting("trials.suture.stitches", Json::array()), setting("trials.suture.count", stitches)};
  if (!stitches.is_array() || stitches.empty())
    throw ConfigError(
        file + ": stitches = " + common::shown_json(stitches) +
        " must be how many there are in a row, or a list of {\"entry_mm\": [x, y], \"entry_deg\": "
        "A, \"exit_mm\": [x, y], \"exit_deg\": A}");
  return {setting("trials.suture.stitches", stitches)};
}

/// The value of `task` in a deployment's configuration: a task, or the file of a path.
std::string named_task(const std::string& file, const Json& json) {
  const std::string task = task_of(file, json);
  check_suture_keys(file, json, task);
  const bool has_path = json.contains("path");
  if (has_path != (task == "path"))
    throw ConfigError(file + (has_path ? ": path = " + common::shown_json(json["path"]) +
                                             " belongs to the task \"path\", not to \"" + task + "\""
                                       : std::string(": path is missing: the CSV file that is followed")));
  if (!has_path) return task;
  const Json& path = json["path"];
  if (!path.is_string() || std::filesystem::path(path.get<std::string>()).extension() != ".csv")
    throw ConfigError(file + ": path = " + common::shown_json(path) + " must be the name of a .csv file");
  return (std::filesystem::path(file).parent_path() / path.get<std::string>()).lexically_normal().string();
}

}  // namespace

bool is_task_file(const std::string& task) { return std::filesystem::path(task).extension() == ".json"; }

std::vector<std::string> settings_of_task(const std::string& file) {
  const Json json = common::read_json_file(file);
  check_keys(file, json);
  std::vector<std::string> settings = {setting("task", named_task(file, json))};
  if (const auto heading = json.find("heading"); heading != json.end()) {
    const bool fixed = heading->is_number();
    settings.push_back(fixed ? "trials.path_heading=fixed" : setting("trials.path_heading", *heading));
    if (fixed) settings.push_back(setting("trials.path_heading_deg", *heading));
  }
  if (const auto stitches = json.find("stitches"); stitches != json.end())
    for (const std::string& each : stitches_settings(file, *stitches)) settings.push_back(each);
  const bool suture = json["task"] == "suture";
  for (const HandedOn& each : kHandedOn) {
    const bool through = suture && each.sets == std::string("reference.speed_m_s");
    if (json.contains(each.key))
      settings.push_back(setting(through ? "suture.speed_m_s" : each.sets, json[each.key]));
  }
  return settings;
}

}  // namespace lodestone::experiments
