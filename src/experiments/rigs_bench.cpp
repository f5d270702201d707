#include "lodestone/experiments/rigs_bench.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/config_layers.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/statistics.h"
#include "lodestone/rig/hidden_deviation.h"

namespace lodestone::experiments {
namespace {

constexpr double kClose_mm = 1.5;

using Records = std::vector<runs::TrialRecord>;
using Figure = std::function<std::optional<double>(const runs::TrialFigures&)>;

/// Mean of a figure over the trials of each rig that have it, by rig.
std::vector<double> by_rig(const Records& trials, std::int64_t per_rig, const Figure& figure) {
  std::vector<double> means;
  for (std::size_t first = 0; first < trials.size(); first += static_cast<std::size_t>(per_rig)) {
    std::vector<double> values;
    for (std::size_t i = first; i < std::min(trials.size(), first + static_cast<std::size_t>(per_rig)); ++i)
      if (const std::optional<double> value = figure(trials[i].figures())) values.push_back(*value);
    if (!values.empty()) means.push_back(common::mean(values));
  }
  return means;
}

std::array<double, 2> interval_of(const std::vector<double>& rigs, const std::string& what) {
  const common::Interval interval =
      common::bootstrap_interval({rigs}, common::mean, common::RandomStream(1, "rigs/" + what));
  return {interval.low, interval.high};
}

std::optional<double> error_mm(const runs::TrialFigures& figures) { return figures.error_mm(); }
std::optional<double> success(const runs::TrialFigures& figures) { return figures.success ? 1.0 : 0.0; }

std::optional<double> close_corners(const runs::TrialFigures& figures) {
  if (!figures.corner_errors_mm || figures.corner_errors_mm->empty()) return std::nullopt;
  const std::vector<double>& errors_mm = *figures.corner_errors_mm;
  const auto close = std::count_if(errors_mm.begin(), errors_mm.end(),
                                   [](double corner_mm) { return corner_mm <= kClose_mm; });
  return static_cast<double>(close) / static_cast<double>(errors_mm.size());
}

runs::RigsTaskSummary summarise(const Records& trials, std::int64_t per_rig) {
  runs::RigsTaskSummary summary;
  static_cast<runs::TaskSummary&>(summary) = summarise_task(trials);
  const std::vector<double> errors_mm = by_rig(trials, per_rig, error_mm);
  summary.mean_error_interval_mm = interval_of(errors_mm, "error");
  summary.success_interval = interval_of(by_rig(trials, per_rig, success), "success");
  const auto worst = std::max_element(errors_mm.begin(), errors_mm.end());
  summary.worst = {worst - errors_mm.begin(), *worst};
  const std::vector<double> late_mm =
      by_rig(trials, per_rig, [](const runs::TrialFigures& figures) { return figures.time_rms_error_mm; });
  if (!late_mm.empty()) summary.time_rms_error_interval_mm = interval_of(late_mm, "time");
  const std::vector<double> corners = by_rig(trials, per_rig, close_corners);
  if (!corners.empty()) {
    summary.corners_within_1_5_mm = common::mean(corners);
    summary.corners_within_1_5_mm_interval = interval_of(corners, "corners");
  }
  const std::vector<double> headings_deg =
      by_rig(trials, per_rig, [](const runs::TrialFigures& figures) { return figures.heading_rms_deg; });
  if (!headings_deg.empty()) summary.heading_rms_interval_deg = interval_of(headings_deg, "heading");
  return summary;
}

/// How much better or worse than another, where both drove the same trials.
void compare(const Records& trials, const Records& other, std::int64_t per_rig, const std::string& what,
             std::optional<double>& mean_mm, std::optional<std::array<double, 2>>& interval_mm) {
  if (trials.size() != other.size()) return;
  std::vector<double> differences_mm = by_rig(trials, per_rig, error_mm);
  const std::vector<double> its_mm = by_rig(other, per_rig, error_mm);
  for (std::size_t rig = 0; rig < its_mm.size(); ++rig) differences_mm[rig] -= its_mm[rig];
  mean_mm = common::mean(differences_mm);
  interval_mm = interval_of(differences_mm, "minus " + what);
}

}  // namespace

std::vector<RigLearner> RigsBenchConfig::learners() const {
  std::vector<RigLearner> learners;
  for (const std::int64_t pulses : adapt) learners.push_back({pulses, false});
  for (const std::int64_t pulses : from_scratch) learners.push_back({pulses, true});
  return learners;
}

std::vector<std::string> RigsBenchConfig::controller_names() const {
  std::vector<std::string> names;
  std::istringstream text(controllers);
  for (std::string name; std::getline(text, name, ',');) {
    const bool known =
        std::find(runs::kControllers.begin(), runs::kControllers.end(), name) != runs::kControllers.end();
    if (!known || std::find(names.begin(), names.end(), name) != names.end())
      throw common::ConfigError(
          "controllers = \"" + controllers + "\": \"" + name +
          (known ? "\" comes twice" : "\" is none of planner, policy, baseline, observer"));
    names.push_back(name);
  }
  if (names.empty() && learners().empty())
    throw common::ConfigError("controllers = \"\": name some of planner, policy, baseline, observer");
  return names;
}

void RigsBenchConfig::validate() const {
  deployment.rig.validate();
  if (deployment.rig.real())
    throw common::ConfigError("rig.backend = \"serial\": rigs are drawn from a seed here; leave it out");
  if (deployment.record.enabled)
    throw common::ConfigError("record.enabled = true: nothing is filmed here; deploy --record films");
  if (deployment.trials.per_rig != 0)
    throw common::ConfigError("trials.per_rig = " + std::to_string(deployment.trials.per_rig) +
                              ": leave it out, trials.count is for each rig here");
  std::set<std::string> names;
  for (const RigLearner& learner : learners()) {
    if (!names.insert(learner.name()).second)
      throw common::ConfigError((learner.from_scratch ? "from_scratch: " : "adapt: ") +
                                std::to_string(learner.pulses) + " pulses come twice");
    DeployConfig config;
    config.deployment = deployment;
    adaptation_of(learner, config, 0).validate();
  }
  if (!adapt.empty() && dynamics.empty() && models.empty())
    throw common::ConfigError(
        "adapt: name the simulator to begin with (--models DIR or --set dynamics=DIR), or --from-scratch");
}

DeployConfig RigsBenchConfig::deploy() const {
  DeployConfig config;
  config.deployment = deployment;
  config.threads = threads;
  config.task = task;
  config.policy = policy.empty() && !models.empty() ? models + "/any_rig" : policy;
  config.dynamics = dynamics.empty() && !models.empty() ? models + "/dynamics_best" : dynamics;
  config.on_rig = "unseen";
  config.deployment.trials.per_rig = config.deployment.trials.count;
  config.deployment.trials.count *= rigs;
  if (decorated) {
    if (config.policy.empty())
      throw common::ConfigError(
          "decorated = true: name a policy (--models DIR or --set policy=DIR); what is put around "
          "controllers stands in the deploy.json beside it, or in that of models/target");
    const std::string file = (policy.empty() ? models + "/target" : policy) + "/deploy.json";
    const common::Json json = common::read_json_file(file);
    if (!json.is_object() || !json.contains("decorators"))
      throw common::ConfigError(file + ": holds no \"decorators\"");
    config.deployment.decorators =
        common::config_from_json<control::DecoratorConfig>(json["decorators"], file);
  }
  return config;
}

DeploymentJob plan_rigs(const RigsBenchConfig& bench, const DeployConfig& config) {
  if (!bench.adapt.empty()) load_start(config.deployment.rig, config.dynamics);  // said now, not after hours
  DeploymentJob job = plan_job(config, bench.controller_names());
  for (const RigLearner& learner : bench.learners()) {
    ControllerSource source;  // what it drives with is another thing on every rig
    source.name = learner.name();
    job.sources.push_back(std::move(source));
  }
  return job;
}

RigsRun::RigsRun(const RigsBenchConfig& bench, const DeployConfig& config, const DeploymentJob& job,
                 const std::string& folder, TrialDriver driver)
    : DeploymentRun(config.deployment, job, folder,
                    learning_driver(std::move(driver), bench.learners(), config, folder)),
      deployment_(config.deployment),
      job_(job),
      learners_(bench.learners()),
      folder_(folder) {
  empty_.rigs = bench.rigs;
  empty_.trials_per_rig = deployment_.trials.per_rig;
  empty_.decorated = bench.decorated;
  empty_.provenance = job.provenance;
}

void RigsRun::save(const std::string& folder) {
  if (progress().done == 0) return;
  common::write_artefact(folder + "/" + runs::RigsResult::kFile, rigs_result());
  common::write_artefact(folder + "/" + runs::RigsSummary::kFile, rigs_summary());
}

runs::RigsSummary RigsRun::rigs_summary() const {
  runs::RigsSummary summary = empty_;
  for (const RigLearner& learner : learners_)
    summary.learned[learner.name()] = summarise_learned(learner, folder_, empty_.rigs);
  for (const Part& part : parts()) {
    if (part.ended.empty()) continue;
    const std::string& name = job_.sources[part.source].name;
    runs::RigsTaskSummary& task = summary.by_controller[name][job_.tasks[part.task]];
    task = summarise(part.ended, empty_.trials_per_rig);
    for (const Part& other : parts()) {
      if (other.task != part.task || &other == &part) continue;
      const std::string& its = job_.sources[other.source].name;
      if (its == "baseline")
        compare(part.ended, other.ended, empty_.trials_per_rig, its, task.minus_baseline_mm,
                task.minus_baseline_interval_mm);
      if (its == "planner" && summary.learned.count(name) != 0)
        compare(part.ended, other.ended, empty_.trials_per_rig, its, task.minus_planner_mm,
                task.minus_planner_interval_mm);
    }
  }
  return summary;
}

runs::RigsResult RigsRun::rigs_result() const {
  runs::RigsResult result;
  for (std::int64_t rig = 0; rig < empty_.rigs; ++rig) {
    const auto hidden = rig::HiddenDeviation::draw(
        deployment_.rig.simulation.deviation,
        unseen_rig(deployment_, job_.tasks.front(), rig * empty_.trials_per_rig).seed, deployment_.rig.coils);
    runs::RigFigures figures;
    figures.moment = hidden.moment;
    figures.friction = hidden.friction;
    figures.viscosity = hidden.viscosity;
    figures.weight = hidden.weight;
    std::vector<double> gains;
    for (const physics::CoilPlacement& coil : hidden.coils) gains.push_back(coil.gain);
    if (!gains.empty()) figures.coil_gain = common::mean(gains);
    result.rigs.push_back(figures);
  }
  for (const Part& part : parts()) {
    const std::vector<double> errors_mm = by_rig(part.ended, empty_.trials_per_rig, error_mm);
    for (std::size_t rig = 0; rig < errors_mm.size(); ++rig)
      result.rigs[rig].mean_error_mm[job_.sources[part.source].name][job_.tasks[part.task]] = errors_mm[rig];
  }
  return result;
}

}  // namespace lodestone::experiments
