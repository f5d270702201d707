#include "lodestone/report/run_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"

namespace lodestone::report {
namespace {

namespace fs = std::filesystem;
using common::DataError;
using common::Json;

StepData read_step(const std::string& folder, const std::string& name, const char* result) {
  const std::string base = folder + "/" + name;
  StepData step;
  step.name = name;
  step.config = read_if_there(base + "/config.json");
  step.manifest = read_if_there(base + "/manifest.json");
  if (result != nullptr) step.result = read_if_there(base + "/" + result);
  step.metrics = read_lines(base + "/metrics.jsonl");
  return step;
}

std::optional<data::Coverage> read_coverage(const std::string& folder) {
  const Json json = read_if_there(folder + "/collect/coverage.json");
  if (!json.is_null()) return data::coverage_from_json(json);
  const std::string dataset = folder + "/collect/transitions.h5";
  if (!fs::exists(dataset)) return std::nullopt;
  return data::measure_coverage(data::read_dataset(dataset));
}

void read_rig(const std::string& base, const std::string& rig, std::vector<DeployData>& rigs) {
  DeployData deploy{rig, read_if_there(base + "/summary.json"), read_if_there(base + "/trials.json")};
  if (!deploy.summary.is_null()) rigs.push_back(std::move(deploy));
}

std::vector<FilmedTrial> read_filmed(const std::string& folder) {
  std::vector<std::string> files;
  if (fs::is_directory(folder))
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".jpg") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  std::vector<FilmedTrial> filmed;
  for (const std::string& file : files)
    filmed.push_back({fs::path(file).stem().string(), common::read_file(file)});
  return filmed;
}

}  // namespace

Json read_if_there(const std::string& path) {
  if (!fs::exists(path)) return nullptr;
  Json json = Json::parse(common::read_file(path), nullptr, false);
  if (json.is_discarded())
    throw DataError(path + " is not JSON: it is damaged; run the step that writes it again");
  return json;
}

std::vector<Json> read_lines(const std::string& path) {
  std::vector<Json> lines;
  if (!fs::exists(path)) return lines;
  std::istringstream stream(common::read_file(path));
  std::int64_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.empty()) continue;
    Json json = Json::parse(line, nullptr, false);
    if (json.is_object()) {
      lines.push_back(std::move(json));
    } else if (stream.peek() != std::istringstream::traits_type::eof()) {
      throw DataError(path + ":" + std::to_string(number) + ": not a JSON object");
    }
  }
  return lines;
}

RunData read_run(const std::string& folder) {
  if (!fs::is_directory(folder))
    throw common::ConfigError("--run " + folder + ": there is no such folder; name the folder of a run");
  RunData run;
  run.folder = folder;
  run.collect = read_step(folder, "collect", nullptr);
  run.coverage = read_coverage(folder);
  run.dynamics = read_step(folder, "dynamics", "evaluation.json");
  run.policy = read_step(folder, "policy", "result.json");
  run.deploy = read_step(folder, "deploy", nullptr);
  for (const char* rig : {"explored", "unseen"}) read_rig(folder + "/deploy/" + rig, rig, run.rigs);
  if (run.rigs.empty()) {
    // Deployed on one kind of rig only: its files lie one folder up.
    const bool known = run.deploy.config.is_object() && run.deploy.config.contains("on_rig") &&
                       run.deploy.config["on_rig"].is_string();
    read_rig(folder + "/deploy", known ? run.deploy.config["on_rig"].get<std::string>() : "explored",
             run.rigs);
  }
  run.filmed = read_filmed(folder + "/deploy/videos");
  return run;
}

Curve curve(const std::vector<Json>& metrics, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    Curve points;
    for (const Json& line : metrics) {
      const std::optional<double> step = number_at(line, {"step"});
      const std::optional<double> value = number_at(line, {key});
      if (step && value) points.emplace_back(*step, *value);
    }
    if (!points.empty()) return points;
  }
  return {};
}

std::optional<double> number_at(const Json& json, std::initializer_list<const char*> path) {
  const Json* at = &json;
  for (const char* key : path) {
    if (!at->is_object() || !at->contains(key)) return std::nullopt;
    at = &at->at(key);
  }
  if (!at->is_number() || !std::isfinite(at->get<double>())) return std::nullopt;
  return at->get<double>();
}

}  // namespace lodestone::report
