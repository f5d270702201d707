#include "lodestone/experiments/deployment_job.h"

#include <algorithm>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/heading_need.h"
#include "lodestone/experiments/oracle.h"
#include "lodestone/experiments/routing.h"
#include "lodestone/runs/tasks_result.h"

namespace lodestone::experiments {
namespace {

const std::vector<std::string> kAll = {"centre", "point", "square", "circle"};

/// Those that are named, but for the path of a file.
bool is_task(const std::string& name) {
  return name == "pose" || name == "suture" || std::find(kAll.begin(), kAll.end(), name) != kAll.end();
}

bool follows_path(const std::vector<std::string>& tasks) {
  return std::any_of(tasks.begin(), tasks.end(), [](const std::string& task) {
    return task == "square" || task == "circle" || task == "path";
  });
}

/// Whether what is followed says how the needle shall lie.
bool wants_headings(const DeployConfig& config, const DeploymentJob& job) {
  if (config.task == "suture") return true;
  return config.deployment.trials.path_heading != geometry::HeadingRule::kNone && follows_path(job.tasks);
}

/// Before anything is driven.
void check_headings(const DeployConfig& config, const DeploymentJob& job) {
  const TrialsConfig& trials = config.deployment.trials;
  if (wants_headings(config, job))
    headed_path(job.path.value_or(geometry::Path::square(trials.square_side_m)), config.deployment);
  if (job.path && job.path->heading().rule() == geometry::HeadingRule::kColumn &&
      trials.path_heading == geometry::HeadingRule::kNone)
    common::log_warning(
        config.task + ": its column heading_rad is left aside; --set trials.path_heading=column follows it");
}

bool is_path_file(const std::string& task) {
  return task.size() > 4 && task.compare(task.size() - 4, 4, ".csv") == 0;
}

void choose_tasks(const DeployConfig& config, DeploymentJob& job) {
  refuse_heading(config.deployment.rig, config.task);
  if (is_path_file(config.task)) {
    job.path = geometry::Path::from_csv(config.task);
    job.tasks = {"path"};
  } else if (config.task == "all") {
    job.tasks = kAll;
  } else if (is_task(config.task)) {
    job.tasks = {config.task};
  } else {
    throw common::ConfigError(
        "task = \"" + config.task +
        "\", must be centre, point, pose, square, circle, suture, all, or the name of a .csv file");
  }
  if (config.target_mm.size() == 2) {
    job.target_m = geometry::Vector2(1e-3 * config.target_mm[0], 1e-3 * config.target_mm[1]);
    check_in_dish(config.deployment.rig, *job.target_m, "target_mm");
  }
  if (job.path)
    for (const geometry::Vector2& point_m : job.path->points_m())
      check_in_dish(config.deployment.rig, point_m, config.task + ": point");
  const auto check_path = [&](const char* task, const geometry::Path& path, const char* key) {
    if (std::find(job.tasks.begin(), job.tasks.end(), task) == job.tasks.end()) return;
    for (const geometry::Vector2& point_m : path.points_m())
      check_in_dish(config.deployment.rig, point_m, std::string(key) + ": point");
  };
  const TrialsConfig& trials = config.deployment.trials;
  check_path("square", geometry::Path::square(trials.square_side_m), "trials.square_side_m");
  check_path("circle", geometry::Path::circle(trials.circle_radius_m), "trials.circle_radius_m");
  if (config.task == "suture")
    check_stitches(config.deployment);
  else
    check_headings(config, job);
}

/// A policy can do what it was trained for, and no other task.
void check_goal(const DeployConfig& config, const inference::Policy& policy, DeploymentJob& job) {
  const std::string name = policy.goal;
  const bool headed = wants_headings(config, job);
  if (headed && !policy.encoder.target_heading)
    common::log_warning(config.policy +
                        " was trained without headings (encoder.target_heading): it is not told how the "
                        "needle shall lie along its way");
  if (config.task == "all") {
    if (name != "point") job.tasks = {name};
    return;
  }
  // Any needle that has come to a point can be turned there.
  const bool turns = config.deployment.turn.current_A > 0.0;
  const bool needs_turning = config.task == "pose" || config.task == "suture";
  const bool fits =
      name == "point" ? !needs_turning || turns : config.task == name || (name == "pose" && headed);
  if (!fits)
    throw common::ConfigError(
        "task = \"" + config.task + "\": " + config.policy + " was trained for goal \"" + name +
        "\" only; use --task " +
        (name == "point" ? "point or a path, turn it in place (configs/best/deploy_pose.json)" : name) +
        ", or another policy");
}

/// Targets and paths that are known before the trials keep clear of every zone.
void check_tasks_keep_out(const DeployConfig& config, const DeploymentJob& job) {
  const geometry::KeepOut keep_out = config.deployment.safety.keeps_out(config.deployment.rig);
  const auto check_path = [&keep_out](const geometry::Path& path, const std::string& what) {
    const std::vector<geometry::Vector2>& points_m = path.points_m();
    for (std::size_t i = 1; i < points_m.size(); ++i)
      check_keeps_out(keep_out, points_m[i - 1], points_m[i], what);
  };
  for (const std::string& task : job.tasks) {
    if (task == "centre")
      check_keeps_out(keep_out, geometry::Vector2::Zero(), geometry::Vector2::Zero(), "task = \"centre\"");
    else if (task == "square")
      check_path(geometry::Path::square(config.deployment.trials.square_side_m), "trials.square_side_m");
    else if (task == "circle")
      check_path(geometry::Path::circle(config.deployment.trials.circle_radius_m), "trials.circle_radius_m");
    else if (job.path)
      check_path(*job.path, config.task);
    else if (job.target_m)
      check_keeps_out(keep_out, *job.target_m, *job.target_m, "target_mm");
  }
}

}  // namespace

void DeployConfig::validate() const {
  deployment.rig.validate();
  if (deployment.record.enabled && deployment.sensor.kind != "camera")
    throw common::ConfigError(
        "record.enabled = true needs sensor.kind = \"camera\": there is nothing to film");
  if (deployment.record.enabled && !deployment.rig.driver.sensor.empty() && deployment.rig.real())
    throw common::ConfigError(
        "record.enabled = true needs images: rig.driver.sensor says where the needle is, and shows none");
  if (!target_mm.empty() && target_mm.size() != 2)
    throw common::ConfigError("target_mm holds " + std::to_string(target_mm.size()) +
                              " numbers, must be two: x and y in mm");
}

DeploymentConfig in_flow(const DeployConfig& config) {
  DeploymentConfig deployment = config.deployment;
  if (config.flow == TrialFlow::kAsRig) return deployment;
  const std::string name = common::name_of(config.flow);
  if (deployment.rig.real())
    throw common::InvalidConfig("flow", name, "be as_rig where the rig is real: its fluid moves as it does");
  const physics::FlowConfig asked = flow_by_drag(config.flow, deployment.rig);
  physics::FlowConfig& flow = deployment.rig.simulation.flow;
  const common::Json told = common::config_to_json(flow);
  if (told != common::config_to_json(physics::FlowConfig()) && told != common::config_to_json(asked))
    throw common::InvalidConfig("flow", name, "be as_rig where rig.simulation.flow tells of another one");
  flow = asked;
  return deployment;
}

DeploymentJob plan_job(const DeployConfig& config) {
  if (config.controller == "auto" && config.policy.empty() && !config.dynamics.empty())
    return plan_job(config, {"planner"});
  if (config.controller == "both" || config.controller == "auto")
    return plan_job(config, {"policy", "baseline"});
  return plan_job(config, {config.controller});
}

DeploymentJob plan_job(const DeployConfig& config, const std::vector<std::string>& controllers) {
  DeploymentJob job;
  choose_tasks(config, job);
  const bool real = config.deployment.rig.real();
  if (real) job.rigs.push_back(RigKind::kReal);
  if (!real && config.on_rig != "unseen") job.rigs.push_back(RigKind::kExplored);
  if (!real && config.on_rig != "explored") job.rigs.push_back(RigKind::kUnseen);
  std::optional<inference::Policy> policy;
  if (!config.policy.empty()) policy = inference::load_policy(config.policy);
  std::optional<SimulatorSource> simulator;
  if (!config.dynamics.empty()) simulator = load_simulator(config.deployment, config.dynamics);
  if (simulator && policy && std::any_of(controllers.begin(), controllers.end(), [](const std::string& name) {
        return name == "planner" || name == runs::kOracle;
      }))
    go_by_cost_to_go(config.deployment, *policy, config.policy, *simulator);
  const SimulatorSource* identified_by = simulator ? &*simulator : nullptr;
  for (const std::string& controller : controllers) {
    if (controller == "planner") {
      if (!simulator)
        throw common::ConfigError(
            "controller = planner: --set dynamics=DIR is missing; name a dynamics checkpoint");
      job.sources.push_back(planner_source(config.deployment, *simulator));
    } else if (controller == "policy") {
      if (!policy)
        throw common::ConfigError(
            "deploy: --policy DIR is missing; name a policy checkpoint, a simulator to plan in (--set "
            "dynamics=DIR), or use --controller baseline");
      check_goal(config, *policy, job);
      job.sources.push_back(policy_source(config.deployment, *policy, config.policy, identified_by));
      job.provenance = common::artefact_from_json<runs::Provenance>(policy->provenance, config.policy);
    } else if (controller == "observer") {
      job.sources.push_back(observer_source(config.deployment));
    } else if (controller == runs::kOracle) {
      job.sources.push_back(oracle_source(config.deployment, simulator ? &*simulator : nullptr));
    } else {
      job.sources.push_back(baseline_source(config.deployment, identified_by));
    }
  }
  if (config.deployment.trials.within == task::Within::kReachable) {
    if (!policy || !policy->region)
      throw common::ConfigError(
          "trials.within = \"reachable\" needs a policy that was trained with task.within = "
          "\"reachable\" (its map of the dish): --policy DIR");
    job.region = policy->region;
  }
  check_tasks_keep_out(config, job);
  for (const std::string& task : job.tasks)
    check_obstacles(config.deployment.trials.obstacles, config.deployment.rig, task);
  job.routes = route_map(config.deployment, identified_by, policy ? &*policy : nullptr);
  return job;
}

}  // namespace lodestone::experiments
