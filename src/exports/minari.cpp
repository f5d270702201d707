#include "lodestone/exports/minari.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shown.h"
#include "lodestone/data/hdf5_image.h"
#include "lodestone/exports/task_episodes.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::exports {
namespace {

constexpr const char* kMinariVersion = "0.5.3";
constexpr double kBytesPerMegabyte = 1e6;
constexpr double kMegabyteDecimals = 10.0;  // Minari rounds to 0.1

void check_id(const std::string& id) {
  // Minari's own rule, with ASCII letters only; a namespace has two letters or more.
  static const std::regex kId("([A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*/)?[A-Za-z0-9_-]+-v[0-9]{1,9}");
  const std::size_t last = id.rfind('/');
  if (!std::regex_match(id, kId) || last == 1)
    throw common::ConfigError("\"" + common::shown(id) +
                              "\" is no id of a Minari dataset: it must be [namespace/]name-v0, of letters, "
                              "digits, - and _");
}

/// gymnasium.spaces.Box as Minari writes it: JSON in a text.
std::string box(const std::vector<double>& low, const std::vector<double>& high) {
  return common::Json{
      {"type", "Box"}, {"dtype", "float64"}, {"shape", {low.size()}}, {"low", low}, {"high", high}}
      .dump();
}

/// Positions and targets within the dish, or as far as any was seen outside of it; headings within a turn.
std::string observation_space(const std::vector<std::string>& columns,
                              const std::vector<TaskEpisode>& episodes, double radius_m) {
  std::vector<double> high;
  for (const std::string& column : columns)
    high.push_back(column.find("heading") == std::string::npos ? radius_m : geometry::kPi);
  for (const TaskEpisode& episode : episodes)
    for (std::size_t i = 0; i < episode.observations.size(); ++i) {
      double& bound = high[i % columns.size()];
      bound = std::max(bound, std::abs(episode.observations[i]));
    }
  std::vector<double> low;
  for (const double bound : high) low.push_back(-bound);
  return box(low, high);
}

void put_episode(const TaskEpisode& episode, std::int64_t id, std::int64_t columns, std::int64_t numbers,
                 data::Hdf5Image& file) {
  const std::string group = "episode_" + std::to_string(id);
  const std::int64_t steps = episode.length();
  file.add_group(group);
  file.add_attribute(group, "id", id);
  file.add_attribute(group, "seed", episode.seed);
  file.add_attribute(group, "total_steps", steps);
  file.add_array(group + "/observations", episode.observations, {steps + 1, columns});
  file.add_array(group + "/actions", episode.actions, {steps, numbers});
  file.add_array(group + "/rewards", episode.rewards, {steps});
  file.add_flags(group + "/terminations", episode.terminations);
  file.add_flags(group + "/truncations", episode.truncations);
  file.add_group(group + "/infos");
  file.add_array(group + "/infos/distance_m", episode.distance_m, {steps + 1});
  file.add_flags(group + "/infos/is_success", episode.success);
}

std::vector<std::string> action_columns(int action_size) {
  std::vector<std::string> columns;
  for (int i = 0; i < action_size; ++i) columns.push_back(data::action_column(i, action_size));
  return columns;
}

/// What the numbers mean, for those who want to know more than Minari asks for.
common::Json facts(const data::Dataset& dataset, const MinariSettings& settings,
                   const std::vector<std::string>& columns) {
  common::Json task = common::config_to_json(settings.task);
  task["dish_radius_m"] = settings.task.dish_radius_m;
  return {{"observation_columns", columns},
          {"action_columns", action_columns(dataset.info.action_size)},
          {"info_columns", {"distance_m", "is_success"}},
          {"recording", data::info_to_json(dataset.info)},
          {"task", std::move(task)},
          {"seed", settings.seed}};
}

common::Json metadata(const data::Dataset& dataset, const MinariSettings& settings,
                      const std::vector<TaskEpisode>& episodes, const MinariSummary& summary) {
  const std::vector<std::string> columns = observation_columns(dataset.info.layout, settings.task.goal);
  const auto numbers = static_cast<std::size_t>(dataset.info.action_size);
  return {{"total_episodes", summary.episodes},
          {"total_steps", summary.steps},
          {"data_format", "hdf5"},
          {"jpeg_encoding", false},
          {"observation_space", observation_space(columns, episodes, settings.task.dish_radius_m)},
          {"action_space", box(std::vector<double>(numbers, -1.0), std::vector<double>(numbers, 1.0))},
          {"dataset_id", settings.id},
          {"minari_version", kMinariVersion},
          {"algorithm_name", "recorded"},
          {"description", "Recorded pulses of a magnetic rig (" + dataset.info.source +
                              "), judged by the task " + common::name_of(settings.task.goal)},
          {"lodestone", facts(dataset, settings, columns)}};
}

void count(const TaskEpisode& episode, MinariSummary& summary) {
  const std::size_t numbers = episode.observations.size() + episode.actions.size() + episode.rewards.size() +
                              episode.distance_m.size();
  const std::size_t flags = episode.terminations.size() + episode.truncations.size() + episode.success.size();
  ++summary.episodes;
  summary.steps += episode.length();
  summary.reached += episode.success.back() != 0 && episode.terminations.back() != 0 ? 1 : 0;
  summary.raw_bytes += static_cast<std::int64_t>(sizeof(double) * numbers + flags);
}

double megabytes(std::size_t bytes) {
  return std::round(static_cast<double>(bytes) / kBytesPerMegabyte * kMegabyteDecimals) / kMegabyteDecimals;
}

}  // namespace

std::string default_minari_id(const std::string& data_path) {
  std::string name = std::filesystem::path(data_path).stem().string();
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  return "lodestone/" + name + "-v0";
}

MinariSummary write_minari(const std::string& root, const data::Dataset& dataset,
                           const MinariSettings& settings) {
  check_id(settings.id);
  MinariSummary summary;
  summary.folder = (std::filesystem::path(root) / settings.id).string();
  if (std::filesystem::exists(summary.folder) && !settings.replace)
    throw common::ConfigError(summary.folder +
                              " exists already: give another id, such as the next version, or --force");

  const std::vector<TaskEpisode> episodes = task_episodes(dataset, settings.task, settings.seed);
  const auto columns =
      static_cast<std::int64_t>(observation_columns(dataset.info.layout, settings.task.goal).size());
  data::Hdf5Image file(summary.folder + "/data/main_data.hdf5");
  for (const TaskEpisode& episode : episodes) {
    put_episode(episode, summary.episodes, columns, dataset.info.action_size, file);
    count(episode, summary);
  }
  const std::string numbers = file.bytes();
  common::Json about = metadata(dataset, settings, episodes, summary);
  about["dataset_size"] = megabytes(numbers.size() + about.dump().size());
  const std::string text = about.dump() + "\n";
  summary.bytes = static_cast<std::int64_t>(numbers.size() + text.size());

  const std::string staged = summary.folder + ".part";
  common::make_folders(staged + "/data");
  common::write_file_atomically(staged + "/data/main_data.hdf5", numbers);
  common::write_file_atomically(staged + "/data/metadata.json", text);
  common::replace_folder(staged, summary.folder);
  return summary;
}

}  // namespace lodestone::exports
