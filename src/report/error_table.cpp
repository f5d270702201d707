#include "lodestone/report/error_table.h"

#include <cstdio>

namespace lodestone::report {
namespace {

using common::Json;

constexpr const char* kTasks[] = {"centre", "point", "pose", "square", "circle", "path"};

/// Table II of the paper.
struct Published {
  const char* task;
  const char* agent;
  double mean_mm;
  double std_mm;
};
constexpr Published kTableTwo[] = {
    {"centre", "trained in a simulator", 31.0, 29.0},
    {"centre", "trained in an MBS", 6.3, 2.1},
    {"point", "trained in an MBS", 5.3, 0.8},
    {"square", "trained in an MBS", 7.4, 0.7},
};

ErrorRow measured(const Json& summary, const char* task, const char* controller, const std::string& rig) {
  ErrorRow row;
  row.task = task;
  row.controller = controller;
  row.rig = rig;
  row.mean_mm = number_at(summary, {"mean_error_mm"});
  row.std_mm = number_at(summary, {"std_error_mm"});
  row.median_mm = number_at(summary, {"median_error_mm"});
  row.rms_mm = number_at(summary, {"rms_error_mm"});
  row.sensed_mean_mm = number_at(summary, {"sensed", "mean_error_mm"});
  row.sensed_std_mm = number_at(summary, {"sensed", "std_error_mm"});
  row.time_rms_mm = number_at(summary, {"time_rms_error_mm"});
  row.hold_mm = number_at(summary, {"hold_error_mm"});
  row.seconds_to_reach = number_at(summary, {"seconds_to_reach"});
  row.success_rate = number_at(summary, {"success_rate"});
  row.trials = number_at(summary, {"n_trials"});
  return row;
}

std::string cell(const std::optional<double>& value, const char* format) {
  if (!value) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, *value);
  return text;
}

void copy_number(const Json& from, const char* key, Json& to, const char* name) {
  if (const auto value = number_at(from, {key})) to[name] = from.at(key);
}

}  // namespace

std::vector<ErrorRow> error_rows(const RunData& run) {
  std::vector<ErrorRow> rows;
  for (const char* task : kTasks) {
    std::vector<ErrorRow> ours;
    for (const DeployData& rig : run.rigs) {
      if (rig.summary.contains(task)) ours.push_back(measured(rig.summary[task], task, "policy", rig.rig));
      if (rig.summary.contains("baseline") && rig.summary["baseline"].contains(task))
        ours.push_back(measured(rig.summary["baseline"][task], task, "baseline", rig.rig));
    }
    if (ours.empty()) continue;
    for (const Published& published : kTableTwo) {
      if (std::string(published.task) != task) continue;
      ErrorRow row;
      row.task = task;
      row.controller = published.agent;
      row.rig = "paper";
      row.mean_mm = published.mean_mm;
      row.std_mm = published.std_mm;
      row.published = true;
      rows.push_back(row);
    }
    rows.insert(rows.end(), ours.begin(), ours.end());
  }
  return rows;
}

std::string error_table_text(const std::vector<ErrorRow>& rows) {
  std::string text = "Errors in mm against the true pose (paper: Table II, on the real rig)\n";
  char line[256];
  std::snprintf(line, sizeof line, "%-7s %-9s %-22s %8s %7s %7s %7s %12s %8s %7s\n", "task", "rig",
                "controller", "mean", "std", "median", "rms", "sensed mean", "success", "trials");
  text += line;
  for (const ErrorRow& row : rows) {
    const auto percent = row.success_rate ? std::optional<double>(100.0 * *row.success_rate) : std::nullopt;
    std::snprintf(line, sizeof line, "%-7s %-9s %-22s %8s %7s %7s %7s %12s %8s %7s\n", row.task.c_str(),
                  row.rig.c_str(), row.controller.c_str(), cell(row.mean_mm, "%.2f").c_str(),
                  cell(row.std_mm, "%.2f").c_str(), cell(row.median_mm, "%.2f").c_str(),
                  cell(row.rms_mm, "%.2f").c_str(), cell(row.sensed_mean_mm, "%.2f").c_str(),
                  cell(percent, "%.0f %%").c_str(), cell(row.trials, "%.0f").c_str());
    text += line;
  }
  return text;
}

Json merged_summary(const RunData& run) {
  Json summary = Json::object();
  for (const DeployData& rig : run.rigs)
    if (rig.rig == "explored" || run.rigs.size() == 1) summary = rig.summary;
  if (run.rigs.size() > 1)
    for (const DeployData& rig : run.rigs) summary[rig.rig] = rig.summary;
  const Json& evaluation = run.dynamics.result;
  if (evaluation.is_object()) {
    Json& dynamics = summary["dynamics"];
    for (const char* key :
         {"position_rms_mm", "heading_rms_deg", "normalised_l2", "k_step", "baselines", "n"})
      if (evaluation.contains(key)) dynamics[key] = evaluation[key];
  }
  if (run.policy.result.is_object()) {
    Json policy = Json::object();
    for (const char* key : {"env_steps", "updates", "train_seconds"})
      copy_number(run.policy.result, key, policy, key);
    summary["policy"] = policy;
  }
  if (run.coverage) {
    const auto rows = number_at(run.collect.config, {"transitions"});
    summary["collect"] = {
        {"transitions", rows ? static_cast<std::int64_t>(*rows) : run.coverage->transitions},
        {"transitions_with_current", run.coverage->transitions},
        {"coverage", run.coverage->fraction},
        {"evenness", run.coverage->evenness}};
  }
  return summary;
}

}  // namespace lodestone::report
