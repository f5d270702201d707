#include "lodestone/report/run_data.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"

namespace lodestone::report {
namespace {

namespace fs = std::filesystem;
using common::DataError;
using common::Json;

StepData read_step(const std::string& folder, const std::string& name) {
  const std::string base = folder + "/" + name;
  StepData step;
  step.name = name;
  step.config = common::read_json_if_there(base + "/config.json");
  step.manifest = common::read_json_if_there(base + "/manifest.json");
  step.metrics = read_lines(base + "/metrics.jsonl");
  return step;
}

std::optional<data::Coverage> read_coverage(const std::string& folder) {
  if (auto found = common::find_artefact<data::Coverage>(folder + "/collect/" + data::Coverage::kFile))
    return found;
  const std::string dataset = folder + "/collect/transitions.h5";
  if (!fs::exists(dataset)) return std::nullopt;
  return data::measure_coverage(data::read_dataset(dataset));
}

double success_radius_mm(const Json& config) {
  constexpr double kOfOldRuns_mm = 3.0;
  if (!config.is_object() || !config.contains("score") || !config["score"].is_object()) return kOfOldRuns_mm;
  const auto found = config["score"].find("success_radius_m");
  return found != config["score"].end() && found->is_number() ? 1e3 * found->get<double>() : kOfOldRuns_mm;
}

void read_deployment(const std::string& folder, RunData& run) {
  const auto summary =
      common::find_artefact<runs::DeploymentSummary>(folder + "/" + runs::DeploymentSummary::kFile);
  if (!summary) return;
  run.provenance = summary->provenance;
  run.reach = common::find_artefact<runs::ReachMap>(folder + "/" + runs::ReachMap::kFile);
  const double radius_mm = success_radius_mm(run.deploy.config);
  for (const auto& [rig, of_rig] : summary->by_rig)
    run.rigs.push_back({rig, of_rig, runs::find_trials(folder + "/" + rig), radius_mm});
  if (!run.rigs.empty()) return;
  std::string rig = summary->scored_by ? "real" : "explored";
  if (!summary->scored_by && run.deploy.config.is_object() && run.deploy.config.contains("on_rig") &&
      run.deploy.config["on_rig"].is_string())
    rig = run.deploy.config["on_rig"].get<std::string>();
  run.rigs.push_back({rig, *summary, runs::find_trials(folder), radius_mm});
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

std::vector<Json> read_lines(const std::string& path) {
  std::vector<Json> lines;
  if (!fs::exists(path)) return lines;
  std::istringstream stream(common::read_file(path));
  std::int64_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.empty()) continue;
    std::optional<Json> json = common::find_json(line);
    if (json && json->is_object()) {
      lines.push_back(std::move(*json));
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
  run.collect = read_step(folder, "collect");
  run.coverage = read_coverage(folder);
  run.recorded =
      common::find_artefact<runs::CollectionFacts>(folder + "/collect/" + runs::CollectionFacts::kFile);
  run.dynamics = read_step(folder, "dynamics");
  run.evaluation = common::find_artefact<runs::DynamicsEvaluation>(folder + "/dynamics/" +
                                                                   runs::DynamicsEvaluation::kFile);
  run.policy = read_step(folder, "policy");
  run.trained = common::find_artefact<runs::PolicyResult>(folder + "/policy/" + runs::PolicyResult::kFile);
  run.cost_to_go = read_step(folder, "cost_to_go");
  run.cost_to_go_trained =
      common::find_artefact<runs::PolicyResult>(folder + "/cost_to_go/" + runs::PolicyResult::kFile);
  run.deployment_only = fs::exists(folder + "/trajectories.csv");
  run.deploy = read_step(folder, run.deployment_only ? "." : "deploy");
  run.deploy.name = "deploy";
  const std::string deployment = run.deployment_only ? folder : folder + "/deploy";
  read_deployment(deployment, run);
  run.filmed = read_filmed(deployment + "/videos");
  if (!run.collect.present() && !run.coverage && !run.evaluation && !run.trained && !run.dynamics.present() &&
      !run.policy.present() && !run.cost_to_go.present() && !run.cost_to_go_trained &&
      !run.deploy.present() && run.rigs.empty())
    throw common::ConfigError(
        "--run " + folder +
        " holds no run: none of the folders collect, dynamics, policy, cost_to_go and deploy is in it "
        "with anything to show");
  return run;
}

Curve curve(const std::vector<Json>& metrics, const char* name) {
  Curve points;
  for (const Json& line : metrics)
    if (line.contains(name) && line[name].is_number() && line.value("step", Json()).is_number())
      points.emplace_back(line["step"].get<double>(), line[name].get<double>());
  return points;
}

}  // namespace lodestone::report
