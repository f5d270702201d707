#include "lodestone/runs/cell_record.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/runs/curves.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using common::Json;

/// To six significant digits: nothing is measured better, and files stay small.
double rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * unit) / unit;
}

double hundredth(double value) { return std::round(100.0 * value) / 100.0; }

std::int64_t seed_of(const Plan& plan, const Cell& cell) {
  return cell.seed.value_or(plan.seed) + cell.seed_offset;
}

std::optional<KeptCurve> read_curve(const std::string& path) {
  if (!fs::exists(path)) return std::nullopt;
  KeptCurve curve;
  std::istringstream lines(common::read_file(path));
  for (std::string line; std::getline(lines, line);) {
    const std::optional<Json> entry = common::find_json(line);
    if (!entry || !entry->is_object() || !entry->contains(curves::kReturn)) continue;
    const auto add = [&](std::vector<double>& to, const char* key) {
      to.push_back(rounded(entry->value(key, 0.0)));
    };
    add(curve.env_steps, "step");
    add(curve.episode_return, curves::kReturn);
    add(curve.success_rate, curves::kSuccess);
    add(curve.seconds, curves::kTrainSeconds);
    add(curve.processor_seconds, curves::kProcessorSeconds);
  }
  return curve;
}

/// What a drawing needs of a trial.
TrialRecord to_draw(const TrialRecord& trial) {
  TrialRecord kept;
  kept.task = trial.task;
  kept.rig = trial.rig;
  kept.controller = trial.controller;
  kept.trial = trial.trial;
  kept.start = trial.start;
  kept.path_mm = trial.path_mm;
  kept.target_mm = trial.target_mm;
  kept.approach = trial.approach;
  kept.truth.emplace().final_error_mm = rounded(trial.figures().final_error_mm);
  kept.truth->success = trial.figures().success;
  kept.completed = trial.completed;
  kept.stop_reason = trial.stop_reason;
  if (trial.trajectory) {
    kept.trajectory.emplace();
    for (const PoseMm& pose : *trial.trajectory)
      kept.trajectory->push_back({hundredth(pose[0]), hundredth(pose[1]), hundredth(pose[2])});
  }
  return kept;
}

KeptTrials kept_trials(const std::vector<TrialRecord>& trials, std::int64_t drawn) {
  KeptTrials kept;
  for (const TrialRecord& trial : trials) {
    const TrialFigures& figures = trial.figures();
    kept.task = trial.task;
    kept.controller = trial.controller;
    kept.error_mm.push_back(rounded(figures.error_mm()));
    kept.success.push_back(figures.success ? 1 : 0);
    kept.stopped.push_back(trial.completed ? 0 : 1);
    const auto add = [](std::vector<double>& to, const std::optional<double>& figure) {
      if (figure) to.push_back(rounded(*figure));
    };
    add(kept.target_deviation_mm, figures.target_deviation_mm);
    add(kept.time_rms_error_mm, figures.time_rms_error_mm);
    add(kept.completion, figures.completion);
    add(kept.corners_reached, figures.corners_reached);
    add(kept.frechet_mm, figures.frechet_mm);
    if (static_cast<std::int64_t>(kept.drawn.size()) < drawn) kept.drawn.push_back(to_draw(trial));
  }
  return kept;
}

/// Whether a configuration has all that was asked for; null asks for nothing.
bool holds_all(const Json& config, const Json& asked) {
  if (asked.is_null()) return true;
  if (!asked.is_object()) return config == asked;
  for (const auto& [key, value] : asked.items())
    if (!value.is_null() && (!config.is_object() || !config.contains(key) || !holds_all(config[key], value)))
      return false;
  return true;
}

/// Names of machines stay where they are; verb and seed are the record's own.
void forget_host(Json& manifest) {
  if (!manifest.is_object()) return;
  for (const char* key : {"verb", "seed", "host", "system"}) manifest.erase(key);
  if (const auto continued = manifest.find("continued"); continued != manifest.end())
    for (Json& part : *continued) forget_host(part);
}

}  // namespace

std::vector<std::string> CellRecord::manifest_texts(const std::string& key) const {
  std::vector<std::string> all;
  for (const Json& part : manifests_of(machine)) {
    const Json value = part.value(key, Json());
    const std::string text = value.is_string() ? value.get<std::string>() : "unknown";
    if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
  }
  return all.empty() ? std::vector<std::string>{"unknown"} : all;
}

std::int64_t CellRecord::threads() const {
  std::int64_t most = 1;
  for (const Json& part : manifests_of(machine)) {
    const Json threads = part.value("threads", Json());
    if (threads.is_number_integer()) most = std::max(most, threads.get<std::int64_t>());
  }
  return most;
}

Json preset_of(const PlanPlace& place, const Cell& cell) {
  return cell.config.empty() ? Json() : common::read_json_if_there(preset_file(place, cell));
}

CellRecord record_of(const Plan& plan, const PlanPlace& place, const Cell& cell) {
  const std::string folder = cell_folder(plan, place, cell.id);
  CellRecord record;
  record.verb = cell.verb;
  record.settings = cell.settings;
  record.seed = seed_of(plan, cell);
  record.preset = preset_of(place, cell);
  record.machine = common::read_json_if_there(folder + "/manifest.json");
  forget_host(record.machine);
  if (const auto state = find_run(folder)) record.seconds = std::round(10.0 * state->seconds) / 10.0;
  if (cell.verb == "collect") {
    record.collected = common::find_artefact<CollectionFacts>(folder + "/" + CollectionFacts::kFile);
    if (fs::exists(folder + "/transitions.h5")) {
      record.mobility = data::measure_mobility(data::read_dataset(folder + "/transitions.h5"));
      for (data::MobilityCell& square : record.mobility->cells) {
        square.x_m = rounded(square.x_m);
        square.y_m = rounded(square.y_m);
        square.moved = rounded(square.moved);
        square.mean_mm = rounded(square.mean_mm);
      }
    }
  }
  record.dynamics = common::find_artefact<DynamicsEvaluation>(folder + "/" + DynamicsEvaluation::kFile);
  if (record.dynamics) {
    record.dynamics->error_map.clear();
    record.dynamics->predictions.reset();
  }
  record.policy = common::find_artefact<PolicyResult>(folder + "/" + PolicyResult::kFile);
  if (record.policy) record.curve = read_curve(folder + "/metrics.jsonl");
  if (const auto trials = find_trials(folder)) record.trials = kept_trials(*trials, cell.drawn_trials);
  return record;
}

bool is_run_of(const Json& config, const Cell& cell, const Json& preset) {
  Json asked = preset.is_object() ? preset : Json::object();
  for (const std::string& setting : cell.settings) {
    const std::size_t equals = setting.find('=');
    const std::string value = setting.substr(equals + 1);
    Json* at = &asked;
    std::istringstream parts(setting.substr(0, equals));
    for (std::string part; std::getline(parts, part, '.');) at = &(*at)[part];
    // Folders of other cells may be anywhere.
    *at = value.find('{') != std::string::npos ? Json() : common::find_json(value).value_or(Json(value));
  }
  return holds_all(config, asked);
}

bool is_record_of(const CellRecord& record, const Plan& plan, const Cell& cell, const Json& preset) {
  return record.verb == cell.verb && record.settings == cell.settings && record.seed == seed_of(plan, cell) &&
         record.preset == preset;
}

}  // namespace lodestone::runs
