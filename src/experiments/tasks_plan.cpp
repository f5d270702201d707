#include "lodestone/experiments/tasks_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/common/random.h"
#include "lodestone/common/spelling.h"
#include "lodestone/experiments/trial_flow.h"
#include "lodestone/runs/tasks_result.h"

namespace lodestone::experiments {
namespace {

using TaskSettings = std::vector<std::string>;

/// A task of the bench: `summary.json` has it under this name, in a group where that has a `/`.
struct TaskVariant {
  std::string name;
  std::string task;       ///< of deploy
  TaskSettings settings;  ///< likewise
  std::string trials_of;  ///< those of one name have the same starts, targets and rigs
};

constexpr const char* kTangentPath = "tangent_path/";
constexpr const char* kEightFile = "/eight.csv";
constexpr double kEightHalfWidth_m = 0.015;
constexpr int kEightPoints = 240;

constexpr const char* kDecoratedPreset = "best/deploy.json";
constexpr const char* kTurnedPreset = "best/deploy_pose.json";  // for what cannot turn the needle itself
constexpr double kReachedHeading_deg = 5.0;                     // that counts as reached
constexpr double kHeldHeading_deg = 4.0;                        // and that decorators leave alone

std::string task_setting(const std::string& key, double value) {
  return key + "=" + common::Json(value).dump();
}

TaskSettings with_more(TaskSettings a, const TaskSettings& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The parts of a list with commas between, each of which must be known.
std::vector<std::string> chosen_names(const std::string& key, const std::string& list,
                                      const std::vector<std::string>& known) {
  std::vector<std::string> names;
  std::istringstream text(list);
  for (std::string name; std::getline(text, name, ',');) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw common::ConfigError(key + " = \"" + list + "\": \"" + name + "\" is none of " +
                                common::joined(known));
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw common::ConfigError(key + " = \"" + list + "\": \"" + name + "\" comes twice");
    names.push_back(name);
  }
  return names;
}

/// Whether deploy knows a task of this name.
bool deploys(const std::string& task) {
  return std::any_of(runs::kTasks.begin(), runs::kTasks.end(),
                     [&task](const char* known) { return task == known; });
}

std::vector<std::string> known_tasks() {
  std::vector<std::string> names;
  for (const char* task : runs::TasksSummary::kAlone)
    if (std::string(task) != "suture" || deploys("suture")) names.emplace_back(task);
  names.insert(names.end(), runs::TasksSummary::kGroups.begin(), runs::TasksSummary::kGroups.end());
  return names;
}

TaskSettings flow_settings(const physics::FlowConfig& flow) {
  return {"rig.simulation.flow.kind=uniform", "rig.simulation.flow.waveform=sine",
          task_setting("rig.simulation.flow.speed_m_s", flow.speed_m_s),
          task_setting("rig.simulation.flow.amplitude", flow.amplitude),
          task_setting("rig.simulation.flow.period_s", flow.period_s)};
}

TaskSettings at_speed(double speed_m_s) { return {task_setting("reference.speed_m_s", speed_m_s)}; }

/// Whether a task wants the needle to lie in some way, which a policy for points is not told.
bool wants_heading(const TaskVariant& variant) {
  return variant.task == "pose" || variant.task == "suture" || variant.name.rfind(kTangentPath, 0) == 0;
}

/// Where headings are wanted, the planner goes by what the policy for poses has learned of their cost.
TaskSettings controller_settings(const std::string& controller, const TaskVariant& variant,
                                 const std::string& models) {
  TaskSettings settings = {"dynamics=" + models + "/dynamics_best"};
  if (controller != runs::kOracle) settings.push_back("controller=" + controller);
  const bool headed = wants_heading(variant);
  const bool plans = controller == "planner" || controller == runs::kOracle;
  if (controller == "policy" || (plans && headed))
    settings.push_back("policy=" + models + (headed ? "/any_pose" : "/any_rig"));
  if (!plans) return settings;
  const bool along_path = variant.name.rfind(kTangentPath, 0) == 0 || variant.task == "suture";
  if (headed) settings.emplace_back("planner.horizon=2");
  if (along_path)  // degrees are lost at corners whatever is done, and matter most at the ends of a stitch
    settings.emplace_back(variant.task == "square"   ? "planner.heading_cost_mm=3.4"
                          : variant.task == "suture" ? "planner.heading_cost_mm=5"
                                                     : "planner.heading_cost_mm=4.2");
  if (controller == runs::kOracle)  // what can be computed of physics
    return with_more(settings, {"planner.candidates=96", "planner.particles=4"});
  if (along_path)  // as best/deploy_headed_path.json and deploy_suture.json have it
    return with_more(settings, {"planner.candidates=192", "planner.iterations=4", "planner.particles=32"});
  if (headed)  // as best/deploy_any_pose.json has it
    return with_more(settings,
                     {"planner.candidates=96", "planner.particles=16", "planner.heading_cost_mm=3"});
  return settings;
}

/// Nothing is put around the oracle.
std::vector<bool> decorations(const std::string& controller) {
  return controller == runs::kOracle ? std::vector<bool>{false} : std::vector<bool>{false, true};
}

}  // namespace

geometry::Path figure_of_eight() {
  std::vector<geometry::Vector2> points_m;
  for (int i = 0; i < kEightPoints; ++i) {
    const double angle_rad = 2.0 * geometry::kPi * i / kEightPoints;
    points_m.emplace_back(kEightHalfWidth_m * std::cos(angle_rad),
                          0.5 * kEightHalfWidth_m * std::sin(2.0 * angle_rad));
  }
  return {std::move(points_m), /*closed=*/true};
}

void write_figure_of_eight(const std::string& folder) {
  std::string text = "x_m,y_m\n";
  const geometry::Path eight = figure_of_eight();
  for (const geometry::Vector2& point_m : eight.points_m())
    text += fmt::format("{:.9f},{:.9f}\n", point_m.x(), point_m.y());
  common::write_file_atomically(folder + kEightFile, text);
}

namespace {

/// The tasks that are asked for.
std::vector<TaskVariant> task_variants(const TasksScale& scale, const physics::RigDescription& rig,
                                       const std::string& folder) {
  const std::vector<std::string> known = known_tasks();
  const std::vector<std::string> wanted =
      scale.tasks.empty() ? known : chosen_names("tasks", scale.tasks, known);
  const auto wants = [&wanted](const char* name) {
    return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
  };
  const TaskSettings close = {"score.success_radius_m=0.001",
                              task_setting("score.success_heading_deg", kReachedHeading_deg)};
  const TaskSettings tangent = with_more(at_speed(0.002), {"trials.path_heading=tangent"});
  std::vector<TaskVariant> all;
  if (wants("pose")) all.push_back({"pose", "pose", close, "pose"});
  if (wants("pose_wide"))
    all.push_back({"pose_wide", "pose", with_more(close, {"rig.simulation.deviation=wide"}), "pose"});
  if (wants("tangent_path")) {
    all.push_back({"tangent_path/circle", "circle", tangent, "circle"});
    all.push_back({"tangent_path/eight", folder + kEightFile, tangent, "eight"});
    all.push_back({"tangent_path/square", "square", tangent, "square"});
  }
  if (wants("suture")) all.push_back({"suture", "suture", {}, "suture"});
  if (wants("obstacles")) all.push_back({"obstacles", "point", {"trials.obstacles.count=3"}, "point"});
  if (wants("still") || wants("flow")) all.push_back({"still/point", "point", {}, "point"});
  if (wants("still") || wants("flow") || wants("square_at_mm_s"))
    all.push_back({"still/square", "square", at_speed(0.002), "square"});
  if (wants("flow")) {
    const TaskSettings flow = flow_settings(flow_by_drag(TrialFlow::kPulsing, rig));
    all.push_back({"flow/point", "point", flow, "point"});
    all.push_back({"flow/square", "square", with_more(at_speed(0.002), flow), "square"});
  }
  if (wants("square_at_mm_s")) {
    all.push_back({"square_at_mm_s/4", "square", at_speed(0.004), "square"});
    all.push_back({"square_at_mm_s/6", "square", at_speed(0.006), "square"});
  }
  return all;
}

}  // namespace

runs::Plan tasks_plan(const TasksScale& scale, const physics::RigDescription& rig,
                      const std::string& folder) {
  runs::Plan plan;
  plan.name = "tasks";
  plan.seed = scale.seed;
  plan.subfolder = "cells";
  const std::vector<std::string> controllers =
      chosen_names("controllers", scale.controllers, {runs::kDrivers.begin(), runs::kDrivers.end()});
  for (const TaskVariant& variant : task_variants(scale, rig, folder)) {
    for (const std::string& controller : controllers) {
      const bool oracle = controller == runs::kOracle;
      for (const bool decorated : decorations(controller)) {
        runs::Cell cell;
        cell.id = variant.name + "/" + controller + (decorated ? "/decorated" : "/bare");
        cell.verb = oracle ? "bench oracle" : "deploy";
        const std::int64_t trials = oracle ? std::min(scale.trials, scale.oracle_trials) : scale.trials;
        cell.settings = with_more(
            {"on_rig=unseen", "task=" + variant.task, "sensor.kind=" + (oracle ? "simulated" : scale.sensor),
             "record.enabled=false", "trials.count=" + std::to_string(trials)},
            with_more(controller_settings(controller, variant, scale.models), variant.settings));
        if (decorated) {
          // Classical controllers bring a needle somewhere, and leave how it lies to what turns it there.
          const bool turned = variant.task == "pose" && controller != "planner" && controller != "policy";
          cell.config = turned ? kTurnedPreset : kDecoratedPreset;
          if (wants_heading(variant))
            cell.settings.push_back(task_setting("decorators.hold_heading_deg", kHeldHeading_deg));
          if (turned) cell.settings.push_back(task_setting("turn.heading_deg", kHeldHeading_deg));
        }
        // Doubles hold integers up to 2^53, and so does JSON everywhere.
        cell.seed = static_cast<std::int64_t>(
            common::derive_seed(static_cast<std::uint64_t>(scale.seed), "tasks/" + variant.trials_of) >> 12);
        plan.cells.push_back(std::move(cell));
      }
    }
  }
  if (plan.cells.empty())
    throw common::ConfigError("bench tasks: tasks = \"" + scale.tasks + "\" and controllers = \"" +
                              scale.controllers + "\" leave nothing to drive");
  return plan;
}

}  // namespace lodestone::experiments
