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

/// A member of the file: what it sets, where it is handed on as it is, and the tasks that it is for; none:
/// all of them.
struct Member {
  std::string key;
  std::string sets;
  std::vector<std::string> tasks;
};
const std::vector<Member>& members() {
  static const std::vector<Member> all = {
      {"task", "", {}},
      {"flow", "flow", {}},
      {"path", "", {"path"}},
      {"heading", "", {"pose", "square", "circle", "path"}},
      {"target_mm", "target_mm", {"point", "pose"}},
      {"seconds", "trials.point_seconds", {"centre", "point", "pose"}},
      {"side_m", "trials.square_side_m", {"square"}},
      {"radius_m", "trials.circle_radius_m", {"circle"}},
      {"speed_m_s", "reference.speed_m_s", {"square", "circle", "path", "suture"}},
      {"laps", "reference.laps", {"square", "circle", "path"}},
      {"stitches", "", {"suture"}},
      {"length_m", "trials.suture.length_m", {"suture"}},
      {"pitch_m", "trials.suture.pitch_m", {"suture"}},
  };
  return all;
}

std::string setting(const std::string& key, const Json& value) { return key + "=" + value.dump(); }

void check_keys(const std::string& file, const Json& json) {
  if (!json.is_object())
    throw ConfigError(file + ": a task is a JSON object {\"task\": ...}, not " + common::shown_json(json));
  std::vector<std::string> known;
  for (const Member& member : members()) known.push_back(member.key);
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

/// What a task does not use would be passed over.
void check_members(const std::string& file, const Json& json, const std::string& task) {
  for (const Member& member : members()) {
    const auto found = json.find(member.key);
    if (found == json.end() || member.tasks.empty() ||
        std::find(member.tasks.begin(), member.tasks.end(), task) != member.tasks.end())
      continue;
    const bool stitched = task == "suture" && member.key == "heading";
    throw ConfigError(
        file + ": " + member.key + " = " + common::shown_json(*found) +
        (stitched ? " is not for the task \"suture\": its stitches have entry_deg and exit_deg"
                  : " belongs to " + common::joined(member.tasks) + ", not to the task \"" + task + "\""));
  }
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
  check_members(file, json, task);
  if (task != "path") return task;
  if (!json.contains("path")) throw ConfigError(file + ": path is missing: the CSV file that is followed");
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
  for (const Member& member : members()) {
    const bool through = suture && member.key == "speed_m_s";
    if (!member.sets.empty() && json.contains(member.key))
      settings.push_back(setting(through ? "suture.speed_m_s" : member.sets, json[member.key]));
  }
  return settings;
}

}  // namespace lodestone::experiments
