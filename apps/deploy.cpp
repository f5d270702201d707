#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "bench_session.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/deployment_run.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "verb.h"

namespace lodestone::apps {

namespace {

struct DeployConfig {
  experiments::DeploymentConfig deployment;
  std::int64_t threads = 0;
  std::string policy;
  std::string dynamics;
  std::string task = "all";
  std::vector<double> target_mm;
  std::string on_rig = "explored";
  std::string controller = "both";
  bool realtime = false;

  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "trials at the same time; 0 means one per processor", {0, 1024});
    v.field("policy", policy, "", "folder of the policy checkpoint");
    v.field("dynamics", dynamics, "", "folder of the dynamics checkpoint that the planner plans in");
    v.field("task", task, "",
            "centre, point, pose, square, circle, all, or a path file.csv (columns x_m,y_m)");
    v.field("target_mm", target_mm, "mm", "x, y of the target of `point`; drawn for each trial when empty",
            {-1000.0, 1000.0});
    v.field("on_rig", on_rig, "",
            "the rig that was explored, rigs with new friction and calibration error, or both",
            {"explored", "unseen", "both"});
    v.field("controller", controller, "",
            "what drives: a trained policy, the proportional baseline, both, or a planner in the learned "
            "simulator",
            {"policy", "baseline", "both", "planner"});
    v.field("realtime", realtime, "", "wait as long as a real rig would");
  }
  void validate() const {
    if (deployment.record.enabled && deployment.sensor.kind != "camera")
      throw common::InvalidConfig("record.enabled", true,
                                  "be false unless sensor.kind = \"camera\": there is nothing to film");
    if (!target_mm.empty() && target_mm.size() != 2)
      throw common::InvalidConfig("target_mm", target_mm, "hold two numbers: x and y in mm");
  }
};

const std::vector<std::string> kTasks = {"centre", "point", "square", "circle"};

bool is_path_file(const std::string& task) {
  return task.size() > 4 && task.compare(task.size() - 4, 4, ".csv") == 0;
}

using experiments::DeploymentJob;

void choose_tasks(const DeployConfig& config, DeploymentJob& job) {
  if (is_path_file(config.task)) {
    job.path = geometry::Path::from_csv(config.task);
    job.tasks = {"path"};
  } else if (config.task == "all") {
    job.tasks = kTasks;
  } else if (config.task == "pose" || std::find(kTasks.begin(), kTasks.end(), config.task) != kTasks.end()) {
    job.tasks = {config.task};
  } else {
    throw common::ConfigError(
        "task = \"" + config.task +
        "\", must be centre, point, pose, square, circle, all, or the name of a .csv file");
  }
  if (config.target_mm.size() == 2) {
    job.target_m = geometry::Vector2(1e-3 * config.target_mm[0], 1e-3 * config.target_mm[1]);
    experiments::check_in_dish(config.deployment.rig, *job.target_m, "target_mm");
  }
  if (job.path)
    for (const geometry::Vector2& point_m : job.path->points_m())
      experiments::check_in_dish(config.deployment.rig, point_m, config.task + ": point");
}

/// A policy can do what it was trained for, and no other task.
void check_goal(const DeployConfig& config, const inference::Policy& policy, DeploymentJob& job) {
  const std::string name = policy.goal;
  if (config.task == "all") {
    if (name != "point") job.tasks = {name};
    return;
  }
  // Any needle that has come to a point can be turned there.
  const bool turns = config.deployment.turn.current_A > 0.0;
  const bool fits = name == "point" ? config.task != "pose" || turns : config.task == name;
  if (!fits)
    throw common::ConfigError(
        "task = \"" + config.task + "\": " + config.policy + " was trained for goal \"" + name +
        "\" only; use --task " +
        (name == "point" ? "point or a path, turn it in place (configs/best/deploy_pose.json)" : name) +
        ", or another policy");
}

DeploymentJob plan_job(const DeployConfig& config) {
  DeploymentJob job;
  choose_tasks(config, job);
  const bool real = config.deployment.rig.real();
  if (real) job.rigs.push_back(experiments::RigKind::kReal);
  if (!real && config.on_rig != "unseen") job.rigs.push_back(experiments::RigKind::kExplored);
  if (!real && config.on_rig != "explored") job.rigs.push_back(experiments::RigKind::kUnseen);
  const bool by_policy = config.controller == "policy" || config.controller == "both";
  std::optional<inference::Policy> policy;
  if (!config.policy.empty()) policy = inference::load_policy(config.policy);
  if (by_policy) {
    if (!policy)
      throw common::ConfigError(
          "deploy: --policy DIR is missing; name a policy checkpoint, or use --controller baseline or "
          "planner");
    check_goal(config, *policy, job);
    job.sources.push_back(experiments::policy_source(config.deployment, *policy, config.policy));
    job.provenance = common::artefact_from_json<runs::Provenance>(policy->provenance, config.policy);
  }
  if (config.controller == "planner") {
    if (config.dynamics.empty())
      throw common::ConfigError(
          "controller = planner: --set dynamics=DIR is missing; name a dynamics checkpoint");
    job.sources.push_back(experiments::planner_source(
        config.deployment, inference::load_dynamics(config.dynamics), config.dynamics));
  }
  if (config.controller == "baseline" || config.controller == "both")
    job.sources.push_back(experiments::baseline_source(config.deployment));
  if (config.deployment.trials.within == task::Within::kReachable) {
    if (!policy || !policy->region)
      throw common::ConfigError(
          "trials.within = \"reachable\" needs a policy that was trained with task.within = "
          "\"reachable\" (its map of the dish): --policy DIR");
    job.region = policy->region;
  }
  return job;
}

void print_heading() {
  std::printf("%-9s %-9s %-7s %8s %8s %8s %8s %8s %8s %9s %7s\n", "rig", "control", "task", "mean", "std",
              "median", "rms", "sensed", "time rms", "reach s", "success");
}

void print_tasks(const std::string& rig, const std::string& controller, const runs::TaskTable& table) {
  const auto text = [](const std::optional<double>& value) {
    char buffer[32] = "-";
    if (value) std::snprintf(buffer, sizeof buffer, "%.2f", *value);
    return std::string(buffer);
  };
  for (const char* task : runs::kTasks) {
    const auto found = table.by_task.find(task);
    if (found == table.by_task.end()) continue;
    const runs::TaskSummary& summary = found->second;
    const runs::ErrorStatistics& errors = summary.truth ? *summary.truth : summary.sensed;
    std::printf("%-9s %-9s %-7s %8s %8s %8s %8s %8s %8s %9s %7s\n", rig.c_str(), controller.c_str(), task,
                text(errors.mean_error_mm).c_str(), text(errors.std_error_mm).c_str(),
                text(errors.median_error_mm).c_str(), text(errors.rms_error_mm).c_str(),
                text(summary.sensed.mean_error_mm).c_str(), text(errors.time_rms_error_mm).c_str(),
                text(errors.seconds_to_reach).c_str(), text(errors.success_rate).c_str());
  }
}

void print_rig(const std::string& rig, const runs::RigSummary& summary) {
  print_tasks(rig, summary.controller.value_or(""), summary.tasks);
  if (summary.baseline) print_tasks(rig, "baseline", *summary.baseline);
}

void print_summary(const DeploymentJob& job, const runs::DeploymentSummary& summary) {
  std::printf(
      "%s", job.rigs.front() == experiments::RigKind::kReal
                ? "Errors in mm as the camera saw them: nobody knows the true pose on a real bench.\n"
                : "Errors in mm against the true pose. centre, point: distance at the end of a trial; paths: "
                  "cross-track error of all samples after the approach.\n");
  print_heading();
  if (summary.by_rig.empty()) print_rig(experiments::to_string(job.rigs.front()), summary);
  for (const auto& [rig, of_rig] : summary.by_rig) print_rig(rig, of_rig);
}

void drive(const DeployConfig& config, const DeploymentJob& job, runs::RunFolder& run) {
  std::unique_ptr<session::RigSession> rig;
  if (config.deployment.rig.real())
    rig = open_bench(config.deployment.rig, config.deployment.sensor, config.deployment.safety, run.path());
  run.begin();
  std::string videos;
  if (config.deployment.record.enabled) common::make_folders(videos = run.file("videos"));
  experiments::DeploymentRun work(
      config.deployment, job, run.path(),
      rig ? experiments::session_driver(*rig, config.deployment, has_operator(), videos)
          : experiments::virtual_driver(config.deployment, config.threads, config.realtime, videos));
  runs::run_resumably(run, work, {"deploy", "trials", 0.0});
  work.write_trials();
  const runs::DeploymentSummary summary = work.summary();
  print_summary(job, summary);
  if (summary.stopped)
    throw common::HardwareError("deploy: stopped: " + *summary.stopped +
                                "; the trials that have ended are kept, --resume goes on with the others");
  run.finish();
}

void deploy(const CommonOptions& options) {
  auto config = resolve_config<DeployConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  const DeploymentJob job = plan_job(config);
  runs::RunRequest request{options.out, "deploy", common::config_to_json(config), config.deployment.seed,
                           options.resume};
  request.free_keys = {"threads", "realtime", "rig.serial.port"};
  runs::RunFolder run(request);
  if (!run.finished()) return drive(config, job, run);
  common::log_info("deploy: " + run.path() + " is finished already");
  print_summary(job,
                common::read_artefact<runs::DeploymentSummary>(run.file(runs::DeploymentSummary::kFile)));
}

}  // namespace

void add_deploy(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb =
      program.add_subcommand("deploy", "drive a rig with a trained policy and a baseline (phase 3)");
  auto options = std::make_shared<CommonOptions>();
  catalogue["deploy"] = [options] { return describe_resolved<DeployConfig>(*options); };
  add_common_options(*verb, *options, /*with_resume=*/true);
  add_virtual_rig_options(*verb, *options);
  verb->add_option_function<std::string>(
      "--models",
      [options](const std::string& folder) {
        options->overrides.push_back({"policy=" + common::Json(folder).dump(), "--models"});
        options->config_files.insert(options->config_files.begin(), folder + "/deploy.json");
      },
      "folder of a released model: its policy, with its deploy.json before any --config");
  const auto text = [&](const char* flag, const char* key, const char* meaning) {
    add_shorthand(*verb, *options, flag, key, Shorthand::kText, meaning);
  };
  text("--policy", "policy", "folder of the policy checkpoint");
  text("--task", "task", "centre, point, pose, square, circle, all, or FILE.csv with columns x_m,y_m");
  add_shorthand(*verb, *options, "--trials", "trials.count", Shorthand::kValue, "trials per task");
  text("--on", "on_rig", "the rig that was explored, rigs never seen, or both: explored, unseen, both");
  text("--sensor", "sensor.kind", "camera or simulated");
  text("--controller", "controller", "policy, baseline, both or planner");
  verb->add_option_function<std::string>(
      "--target-mm",
      [options](const std::string& value) {
        options->overrides.push_back({"target_mm=[" + value + "]", "--target-mm"});
      },
      "X,Y of the target of `point` in mm");
  verb->add_flag_callback(
      "--record",
      [options] {
        options->overrides.push_back({"record.enabled=true", "--record"});
      },
      "film the first trial of every task, rig and controller");
  verb->add_flag_callback(
      "--realtime",
      [options] {
        options->overrides.push_back({"realtime=true", "--realtime"});
      },
      "wait as long as a real rig would (one trial at a time)");
  verb->callback([options] { deploy(*options); });
}

}  // namespace lodestone::apps
