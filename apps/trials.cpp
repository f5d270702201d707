#include "trials.h"

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/files.h"
#include "lodestone/experiments/task_file.h"

namespace lodestone::apps {

namespace {

constexpr const char* kRow = "%-9s %-9s %-7s %7s %7s %7s %7s %9s %9s %8s %8s %8s %8s %7s %7s\n";

void print_heading() {
  std::printf(kRow, "rig", "control", "task", "mean", "std", "median", "sensed", "time rms", "complete",
              "corners", "heading", "reach s", "success", "stopped", "trials");
}

void print_tasks(const std::string& rig, const std::string& controller, const runs::TaskTable& table) {
  const auto number = [](const std::optional<double>& value, const char* format) {
    char buffer[32] = "-";
    if (value) std::snprintf(buffer, sizeof buffer, format, *value);
    return std::string(buffer);
  };
  const auto text = [&](const std::optional<double>& value) { return number(value, "%.2f"); };
  const auto share = [&](const std::optional<double>& value) {
    return value ? number(100.0 * *value, "%.0f %%") : "-";
  };
  for (const char* task : runs::kTasks) {
    const auto found = table.by_task.find(task);
    if (found == table.by_task.end()) continue;
    const runs::TaskSummary& summary = found->second;
    const runs::ErrorStatistics& errors = summary.truth ? *summary.truth : summary.sensed;
    const std::optional<double>& heading_deg =
        errors.heading_rms_deg ? errors.heading_rms_deg : errors.heading_error_deg;
    std::printf(kRow, rig.c_str(), controller.c_str(), task, text(errors.mean_error_mm).c_str(),
                text(errors.std_error_mm).c_str(), text(errors.median_error_mm).c_str(),
                text(summary.sensed.mean_error_mm).c_str(), text(errors.time_rms_error_mm).c_str(),
                share(errors.stitches_made_share ? errors.stitches_made_share : errors.completion).c_str(),
                share(errors.corners_reached).c_str(), number(heading_deg, "%.1f").c_str(),
                text(errors.seconds_to_reach).c_str(), share(errors.success_rate).c_str(),
                std::to_string(summary.stopped).c_str(), std::to_string(summary.n_trials).c_str());
  }
}

void print_rig(const std::string& rig, const runs::RigSummary& summary) {
  print_tasks(rig, summary.controller.value_or(""), summary.tasks);
  if (summary.baseline) print_tasks(rig, "baseline", *summary.baseline);
}

/// How zones were kept out of, where there were any.
void print_touches(const std::string& rig, const std::string& controller, const runs::TaskTable& table) {
  for (const auto& [task, of_task] : table.by_task) {
    const runs::ErrorStatistics& errors = of_task.truth ? *of_task.truth : of_task.sensed;
    if (of_task.unreachable.value_or(0) > 0)
      std::printf("%s, %s, %s: in %lld of %lld trials no way led past the obstacles; they count as failed.\n",
                  rig.c_str(), controller.c_str(), task.c_str(), static_cast<long long>(*of_task.unreachable),
                  static_cast<long long>(of_task.n_trials));
    if (!errors.touching_rate || !errors.least_clearance_mm || !errors.touching_interval) continue;
    std::printf(
        "%s, %s, %s: %.0f %% of the trials touched a keep-out zone (95 %%: %.0f to %.0f %%); least clearance "
        "%.2f mm.\n",
        rig.c_str(), controller.c_str(), task.c_str(), 100.0 * *errors.touching_rate,
        100.0 * errors.touching_interval->at(0), 100.0 * errors.touching_interval->at(1),
        *errors.least_clearance_mm);
  }
}

void print_touches(const std::string& rig, const runs::RigSummary& summary) {
  print_touches(rig, summary.controller.value_or(""), summary.tasks);
  if (summary.baseline) print_touches(rig, "baseline", *summary.baseline);
}

/// A task, or what the file that describes one says; single values win over that.
void use_task(CommonOptions& options, const std::string& value) {
  if (!experiments::is_task_file(value)) {
    options.overrides.push_back({"task=" + common::Json(value).dump(), "--task"});
    return;
  }
  std::vector<Override> settings;
  for (const std::string& setting : experiments::settings_of_task(value))
    settings.push_back({setting, "--task " + value});
  options.overrides.insert(options.overrides.begin(), settings.begin(), settings.end());
}

}  // namespace

void add_trials_options(Verb& verb, CommonOptions& options) {
  add_models_option(verb, options);
  const auto text = [&](const char* flag, const char* key, const char* meaning) {
    add_shorthand(verb, options, flag, key, Shorthand::kText, meaning);
  };
  text("--policy", "policy", "folder of the policy checkpoint");
  verb.add_option(
      "--task", [&options](const std::string& value) { use_task(options, value); },
      "centre, point, pose, square, circle, suture, all, FILE.csv with columns x_m,y_m (and heading_rad), or "
      "a "
      "FILE.json that describes one");
  add_shorthand(verb, options, "--trials", "trials.count", Shorthand::kValue, "trials per task");
  text("--on", "on_rig", "the rig that was explored, rigs never seen, or both: explored, unseen, both");
  text("--sensor", "sensor.kind", "camera or simulated");
  text("--flow", "flow", "of a virtual rig's fluid: steady or pulsing, its drag up to half of friction");
  verb.add_option(
      "--target-mm",
      [&options](const std::string& value) {
        options.overrides.push_back({"target_mm=[" + value + "]", "--target-mm"});
      },
      "X,Y of the target of `point` in mm");
}

experiments::TrialFolders make_trial_folders(const experiments::DeployConfig& config,
                                             const runs::RunFolder& run) {
  experiments::TrialFolders folders;
  if (config.deployment.record.enabled) common::make_folders(folders.videos = run.file("videos"));
  if ((folders.mcap = config.mcap).enabled) common::make_folders(folders.logs = run.file("logs"));
  return folders;
}

void print_deployment(const experiments::DeploymentJob& job, const runs::DeploymentSummary& summary) {
  std::printf(
      "Errors in mm %s. centre, point: distance at the end of a trial; paths: cross-track RMS of a trial; "
      "suture: RMS at the ends of its stitches; heading, in degrees: at the end, or RMS along a path or "
      "suture.\n",
      job.rigs.front() == experiments::RigKind::kReal
          ? "as the camera saw them: nobody knows the true pose on a real bench"
          : "against the true pose");
  print_heading();
  if (summary.by_rig.empty()) print_rig(experiments::to_string(job.rigs.front()), summary);
  for (const auto& [rig, of_rig] : summary.by_rig) print_rig(rig, of_rig);
  if (summary.by_rig.empty()) print_touches(experiments::to_string(job.rigs.front()), summary);
  for (const auto& [rig, of_rig] : summary.by_rig) print_touches(rig, of_rig);
  std::int64_t changed = 0;
  const auto count = [&changed](const runs::TaskTable& table) {
    for (const auto& [task, of_task] : table.by_task) changed += of_task.rig_changed.value_or(0);
  };
  count(summary.tasks);
  if (summary.baseline) count(*summary.baseline);
  if (changed > 0)
    std::printf(
        "In %lld trials pulses moved the needle otherwise than the simulator expects of any strength of "
        "the rig (rig_changed).\n",
        static_cast<long long>(changed));
}

}  // namespace lodestone::apps
