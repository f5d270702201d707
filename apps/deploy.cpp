#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "bench_session.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/recorder.h"
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
    deployment.rig.validate();
    if (deployment.record.enabled && deployment.sensor.kind != "camera")
      throw common::ConfigError(
          "record.enabled = true needs sensor.kind = \"camera\": there is nothing to film");
    if (!target_mm.empty() && target_mm.size() != 2)
      throw common::ConfigError("target_mm holds " + std::to_string(target_mm.size()) +
                                " numbers, must be two: x and y in mm");
  }
};

const std::vector<std::string> kTasks = {"centre", "point", "square", "circle"};

bool is_path_file(const std::string& task) {
  return task.size() > 4 && task.compare(task.size() - 4, 4, ".csv") == 0;
}

/// What is to be run, checked before anything is written.
struct Job {
  std::vector<std::string> tasks;
  std::optional<geometry::Path> path;
  std::optional<geometry::Vector2> target_m;
  std::optional<task::Region> region;  ///< that starts and targets lie in
  std::vector<experiments::RigKind> rigs;
  std::vector<experiments::ControllerSource> sources;
  common::Json provenance = common::Json::object();  ///< of the policy
};

void choose_tasks(const DeployConfig& config, Job& job) {
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
  if (config.target_mm.size() == 2)
    job.target_m = geometry::Vector2(1e-3 * config.target_mm[0], 1e-3 * config.target_mm[1]);
}

/// A policy can do what it was trained for, and no other task.
void check_goal(const DeployConfig& config, const inference::Policy& policy, Job& job) {
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

Job plan_job(const DeployConfig& config) {
  Job job;
  choose_tasks(config, job);
  if (config.on_rig != "unseen") job.rigs.push_back(experiments::RigKind::kExplored);
  if (config.on_rig != "explored") job.rigs.push_back(experiments::RigKind::kUnseen);
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
    job.provenance = policy->provenance;
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
  if (config.deployment.trials.within == "reachable") {
    if (!policy || !policy->region)
      throw common::ConfigError(
          "trials.within = \"reachable\" needs a policy that was trained with task.within = "
          "\"reachable\" (its map of the dish): --policy DIR");
    job.region = policy->region;
  }
  return job;
}

/// Writes trials.json one trial at a time, so that long deployments need no memory for it.
class TrialsFile {
 public:
  explicit TrialsFile(const std::string& file) : path_(file), staged_(file + ".part"), out_(staged_) {
    out_ << "[";
  }
  void write(const experiments::TrialResult& result) {
    out_ << (first_ ? "\n" : ",\n") << experiments::trial_to_json(result).dump();
    first_ = false;
    check();
  }
  void finish() {
    out_ << "\n]\n";
    out_.close();
    check();
    std::filesystem::rename(staged_, path_);
  }

 private:
  void check() const {
    if (!out_) throw common::IoError("cannot write " + staged_ + ": check the space on the disk");
  }
  std::string path_;
  std::string staged_;
  std::ofstream out_;
  bool first_ = true;
};

void print_row(const char* rig, const std::string& controller, const std::string& task,
               const common::Json& summary) {
  const auto text = [](const common::Json& value) {
    char buffer[32] = "-";
    if (value.is_number()) std::snprintf(buffer, sizeof buffer, "%.2f", value.get<double>());
    return std::string(buffer);
  };
  std::printf("%-9s %-9s %-7s %8s %8s %8s %8s %8s %8s %9s %7s\n", rig, controller.c_str(), task.c_str(),
              text(summary["mean_error_mm"]).c_str(), text(summary["std_error_mm"]).c_str(),
              text(summary["median_error_mm"]).c_str(), text(summary["rms_error_mm"]).c_str(),
              text(summary["sensed"]["mean_error_mm"]).c_str(), text(summary["time_rms_error_mm"]).c_str(),
              text(summary["seconds_to_reach"]).c_str(), text(summary["success_rate"]).c_str());
}

common::Json summarise_task(const std::vector<experiments::TrialResult>& results) {
  std::vector<const experiments::TrialScore*> truth;
  std::vector<const experiments::TrialScore*> sensed;
  std::int64_t stopped = 0;
  for (const experiments::TrialResult& result : results) {
    truth.push_back(&result.truth);
    sensed.push_back(&result.sensed);
    stopped += result.completed ? 0 : 1;
  }
  common::Json summary = experiments::summarise_trials(truth);
  summary["n_stopped"] = stopped;
  summary["sensed"] = experiments::summarise_trials(sensed);
  return summary;
}

/// The tasks' keys stand at the top for what was asked for, and under "baseline" for what it is held against.
common::Json& part_of(common::Json& summary, const experiments::ControllerSource& source) {
  return source.name == "baseline" ? summary["baseline"] : summary;
}

/// Runs everything; keeps files, progress and the summary in step.
class Run {
 public:
  Run(const DeployConfig& config, const Job& job, const std::string& out)
      : config_(config),
        job_(job),
        out_(out),
        deployment_(config.deployment),
        pool_(config.realtime ? 1 : static_cast<std::size_t>(config.threads)),
        recorder_(out + "/trajectories.csv"),
        progress_("deploy",
                  static_cast<std::int64_t>(job.rigs.size() * job.sources.size() * job.tasks.size()) *
                      config.deployment.trials.count) {}

  /// Summary of one kind of rig; the baseline's stands under its own key.
  common::Json on(experiments::RigKind kind, const std::string& folder) {
    TrialsFile trials(folder + "/trials.json");
    common::Json summary = common::Json::object();
    for (const experiments::ControllerSource& source : job_.sources) {
      common::Json& part = part_of(summary, source);
      for (const std::string& task : job_.tasks) {
        const auto results = run_task(kind, source, task, trials);
        part[task] = summarise_task(results);
      }
    }
    trials.finish();
    common::write_file_atomically(folder + "/summary.json", summary.dump(1) + "\n");
    return summary;
  }
  void finish() { progress_.finish(); }

 private:
  std::vector<experiments::TrialResult> run_task(experiments::RigKind kind,
                                                 const experiments::ControllerSource& source,
                                                 const std::string& task, TrialsFile& trials) {
    std::vector<experiments::TrialPlan> plans;
    for (std::int64_t index = 0; index < config_.deployment.trials.count; ++index)
      plans.push_back(experiments::plan_trial(
          config_.deployment, task, index, job_.target_m, job_.path,
          [this](const geometry::Pose2& pose) { return deployment_.fits(pose); }, region()));
    std::vector<experiments::TrialResult> results;
    const std::size_t batch = 2 * pool_.size();
    for (std::size_t first = 0; first < plans.size(); first += batch) {
      const std::size_t last = std::min(first + batch, plans.size());
      auto part = deployment_.run({plans.begin() + static_cast<std::ptrdiff_t>(first),
                                   plans.begin() + static_cast<std::ptrdiff_t>(last)},
                                  kind, source, pool_, config_.realtime, video_folder());
      if (common::interrupted())
        throw common::Interrupted("deploy: stopped by the user; the finished trials are in " + out_ +
                                  "/trajectories.csv");
      for (experiments::TrialResult& result : part) {
        recorder_.write(result);
        trials.write(result);
        if (!result.completed)
          common::log_warning("trial " + std::to_string(result.plan.index) + " of " + task +
                              " stopped early: " + result.stop_reason);
        results.push_back(std::move(result));
      }
      done_ += static_cast<std::int64_t>(last - first);
      progress_.update(done_, source.name + " " + task);
    }
    return results;
  }

  const task::Region* region() const { return job_.region ? &*job_.region : nullptr; }
  std::string video_folder() const { return config_.deployment.record.enabled ? out_ + "/videos" : ""; }

  const DeployConfig& config_;
  const Job& job_;
  std::string out_;
  experiments::Deployment deployment_;
  common::ThreadPool pool_;
  experiments::Recorder recorder_;
  common::Progress progress_;
  std::int64_t done_ = 0;
};

/// The same tasks on the bench that is connected, one trial after the other, scored by what the camera saw.
class BenchRun {
 public:
  BenchRun(const DeployConfig& config, const Job& job, const std::string& out)
      : config_(config),
        job_(job),
        out_(out),
        bench_(open_bench(config.deployment.rig, config.deployment.sensor, config.deployment.safety, out)),
        recorder_(out + "/trajectories.csv"),
        progress_("deploy", static_cast<std::int64_t>(job.sources.size() * job.tasks.size()) *
                                config.deployment.trials.count) {}

  /// Everything that was measured is written, also when the bench stops in between.
  common::Json run() {
    TrialsFile trials(out_ + "/trials.json");
    common::Json summary = common::Json::object();
    for (const experiments::ControllerSource& source : job_.sources) {
      common::Json& part = part_of(summary, source);
      for (const std::string& task : job_.tasks) {
        std::vector<experiments::TrialResult> results;
        for (std::int64_t index = 0; index < config_.deployment.trials.count && stop_.empty(); ++index) {
          results.push_back(run_one(source, task, index));
          recorder_.write(results.back());
          trials.write(results.back());
          progress_.update(++done_, source.name + " " + task);
        }
        if (!results.empty()) part[task] = summarise_task(results);
      }
    }
    trials.finish();
    progress_.finish();
    return summary;
  }
  /// Why the bench was stopped for good; empty when it was not.
  const std::string& stop() const { return stop_; }

 private:
  experiments::TrialResult run_one(const experiments::ControllerSource& source, const std::string& task,
                                   std::int64_t index) {
    const experiments::TrialPlan plan = experiments::plan_trial(
        config_.deployment, task, index, job_.target_m, job_.path,
        [this](const geometry::Pose2& pose) { return bench_->fits(pose); },
        job_.region ? &*job_.region : nullptr);
    if (has_operator()) bench_->place(plan.start);
    std::optional<experiments::TrialVideo> video;
    const experiments::RecordingConfig& record = config_.deployment.record;
    if (record.enabled && index < record.trials)
      video.emplace(out_ + "/videos/real-" + source.name + "-" + task + "-" + std::to_string(index), record,
                    config_.deployment.loop.period_s(), rig::bench_of(config_.deployment.rig),
                    source.action.scale, plan);
    experiments::TrialResult result = experiments::run_on_session(
        *bench_, config_.deployment, plan, source, {}, [&](const control::StepRecord& step) {
          const session::CameraPoseSensor* camera = bench_->camera();
          if (video && camera->calibration())
            video->show(camera->frame(), camera->calibration()->camera, step);
        });
    if (video) video->finish();
    if (!result.completed)
      common::log_warning("trial " + std::to_string(index) + " of " + task +
                          " stopped early: " + result.stop_reason);
    if (bench_->coils().latched()) stop_ = bench_->coils().reason();
    return result;
  }

  const DeployConfig& config_;
  const Job& job_;
  std::string out_;
  std::unique_ptr<session::RigSession> bench_;
  experiments::Recorder recorder_;
  common::Progress progress_;
  std::int64_t done_ = 0;
  std::string stop_;
};

void print_table(const common::Json& summary, const char* rig, const std::string& first) {
  const auto print_part = [&](const common::Json& part, const char* controller) {
    for (const auto& [task, values] : part.items())
      if (values.contains("mean_error_mm")) print_row(rig, controller, task, values);
  };
  print_part(summary, first.c_str());
  if (summary.contains("baseline")) print_part(summary["baseline"], "baseline");
}

void print_heading() {
  std::printf("%-9s %-9s %-7s %8s %8s %8s %8s %8s %8s %9s %7s\n", "rig", "control", "task", "mean", "std",
              "median", "rms", "sensed", "time rms", "reach s", "success");
}

void deploy_on_bench(const DeployConfig& config, const Job& job, const std::string& out) {
  BenchRun run(config, job, out);
  common::Json summary = run.run();
  summary["scored_by"] = "camera";
  if (!run.stop().empty()) summary["stopped"] = run.stop();
  summary.update(job.provenance);
  common::write_file_atomically(out + "/summary.json", summary.dump(1) + "\n");
  std::printf("Errors in mm as the camera saw them: nobody knows the true pose on a real bench.\n");
  print_heading();
  print_table(summary, "real", job.sources.front().name);
  if (common::interrupted())
    throw common::Interrupted("deploy: stopped by the user; the finished trials are in " + out);
  if (!run.stop().empty()) throw common::HardwareError("deploy: stopped: " + run.stop());
}

void deploy(const CommonOptions& options) {
  auto config = resolve_config<DeployConfig>(options);
  if (options.out.empty())
    throw common::ConfigError("deploy: --out DIR is missing; name the folder to write into");
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  const Job job = plan_job(config);
  common::start_run_folder(options.out, "deploy", common::config_to_json(config), config.deployment.seed,
                           false);
  if (config.deployment.record.enabled) common::make_folders(options.out + "/videos");
  if (config.deployment.rig.real()) return deploy_on_bench(config, job, options.out);
  Run run(config, job, options.out);
  const bool both = job.rigs.size() > 1;
  common::Json by_rig = common::Json::object();
  for (const experiments::RigKind kind : job.rigs) {
    const std::string folder = both ? options.out + "/" + experiments::to_string(kind) : options.out;
    common::make_folders(folder);
    by_rig[experiments::to_string(kind)] = run.on(kind, folder);
  }
  run.finish();
  // The tasks' keys at the top are those of the explored rig when both are run; each rig then stands below
  // them.
  common::Json summary = by_rig.front();
  if (both) {
    for (const auto& [kind, values] : by_rig.items()) summary[kind] = values;
  }
  summary.update(job.provenance);
  common::write_file_atomically(options.out + "/summary.json", summary.dump(1) + "\n");
  std::printf(
      "Errors in mm against the true pose. centre, point: distance at the end of a trial; paths: cross-track "
      "error of all samples after the approach.\n");
  print_heading();
  for (const auto& [kind, values] : by_rig.items())
    print_table(values, kind.c_str(), job.sources.front().name);
}

}  // namespace

void add_deploy(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb =
      program.add_subcommand("deploy", "drive a rig with a trained policy and a baseline (phase 3)");
  auto options = std::make_shared<CommonOptions>();
  catalogue["deploy"] = [options] { return describe_resolved<DeployConfig>(*options); };
  add_common_options(*verb, *options);
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
