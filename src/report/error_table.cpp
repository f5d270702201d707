#include "lodestone/report/error_table.h"

#include <cmath>
#include <cstdio>

#include "trial_data.h"

namespace lodestone::report {
namespace {

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

ErrorRow measured(const runs::TaskSummary& summary, const char* task, const std::string& controller,
                  const std::string& rig) {
  ErrorRow row{task, controller, rig};
  row.trials = static_cast<double>(summary.n_trials);
  row.sensed_mean_mm = summary.sensed.mean_error_mm;
  row.sensed_std_mm = summary.sensed.std_error_mm;
  row.stopped = static_cast<double>(summary.stopped);
  const runs::ErrorStatistics& best = summary.truth ? *summary.truth : summary.sensed;
  row.target_deviation_mm = best.target_deviation_mm;
  row.completion = best.completion;
  row.corners_reached = best.corners_reached;
  row.time_rms_mm = best.time_rms_error_mm;
  row.frechet_mm = best.frechet_mm;
  row.heading_rms_deg = best.heading_rms_deg;
  row.stitches_made = best.stitches_made;
  row.stitches_made_share = best.stitches_made_share;
  row.stitch_worst_mm = best.stitch_worst_mm;
  row.stitch_worst_deg = best.stitch_worst_deg;
  row.duration_s = best.duration_s;
  row.charge_As = best.charge_As;
  row.heat_J = best.heat_J;
  row.clearance_mm = best.clearance_mm;
  row.least_clearance_mm = best.least_clearance_mm;
  row.touching_rate = best.touching_rate;
  if (summary.unreachable) row.unreachable = static_cast<double>(*summary.unreachable);
  if (const auto& range = best.touching_interval)
    row.touching_interval = common::Interval{range->at(0), range->at(1)};
  if (!summary.truth) return row;
  row.mean_mm = summary.truth->mean_error_mm;
  row.std_mm = summary.truth->std_error_mm;
  row.median_mm = summary.truth->median_error_mm;
  row.rms_mm = summary.truth->rms_error_mm;
  row.hold_mm = summary.truth->hold_error_mm;
  row.seconds_to_reach = summary.truth->seconds_to_reach;
  row.success_rate = summary.truth->success_rate;
  return row;
}

void add_intervals(const std::vector<const Trial*>& trials, ErrorRow& row) {
  std::vector<double> errors_mm, headings_deg;
  std::int64_t successes = 0;
  for (const Trial* trial : trials) {
    if (trial->heading_rms_deg) headings_deg.push_back(*trial->heading_rms_deg);
    if (std::isfinite(trial->error_mm)) errors_mm.push_back(trial->error_mm);
    successes += trial->success ? 1 : 0;
  }
  if (!headings_deg.empty())
    row.heading_rms_interval_deg =
        common::bootstrap_interval({headings_deg}, common::mean, common::RandomStream(1, "bootstrap"));
  if (errors_mm.empty()) return;
  row.rms_interval_mm =
      common::bootstrap_interval({errors_mm}, common::root_mean_square, common::RandomStream(1, "bootstrap"));
  row.success_interval = common::wilson_interval(successes, static_cast<std::int64_t>(trials.size()));
}

/// What this run measured of a task on one kind of rig: what was asked for, then the baseline.
void add_measured(const DeployData& rig, const char* task, std::vector<ErrorRow>& rows) {
  const std::vector<Trial> trials = read_trials(rig);
  const auto add = [&](const runs::TaskTable& table, const std::string& controller) {
    const auto found = table.by_task.find(task);
    if (found == table.by_task.end()) return;
    rows.push_back(measured(found->second, task, controller, rig.rig));
    add_intervals(select(trials, task, controller), rows.back());
  };
  add(rig.summary.tasks, rig.driver());
  if (rig.summary.baseline) add(*rig.summary.baseline, "baseline");
}

std::string cell(const std::optional<double>& value, const char* format) {
  if (!value) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, *value);
  return text;
}

}  // namespace

std::vector<ErrorRow> error_rows(const RunData& run) {
  std::vector<ErrorRow> rows;
  for (const char* task : runs::kTasks) {
    std::vector<ErrorRow> ours;
    for (const DeployData& rig : run.rigs) add_measured(rig, task, ours);
    if (ours.empty()) continue;
    for (const Published& published : kTableTwo) {
      if (std::string(published.task) != task) continue;
      ErrorRow row{task, published.agent, "paper"};
      const bool path = row.task == "square";
      (path ? row.target_deviation_mm : row.mean_mm) = published.mean_mm;
      (path ? row.target_deviation_std_mm : row.std_mm) = published.std_mm;
      row.published = true;
      rows.push_back(row);
    }
    rows.insert(rows.end(), ours.begin(), ours.end());
  }
  return rows;
}

std::string error_table_text(const std::vector<ErrorRow>& rows) {
  const char* const format = "%-7s %-9s %-22s %6s %6s %6s %7s %10s %9s %9s %8s %8s %8s %7s\n";
  char line[256];
  std::string text =
      "Errors in mm against the true pose (paper: Table II, on the real rig): of points the distance at the "
      "end, of "
      "paths the cross-track RMS, of sutures the RMS at the ends of the stitches;\nto target: mean deviation "
      "from the targets along a path, as the paper has "
      "it; RMS in "
      "time: distance to the moving reference\n";
  std::snprintf(line, sizeof line, format, "task", "rig", "controller", "mean", "std", "rms", "sensed",
                "to target", "time rms", "complete", "corners", "success", "stopped", "trials");
  text += line;
  const auto share = [](const std::optional<double>& value) {
    return cell(value ? std::optional<double>(100.0 * *value) : std::nullopt, "%.0f %%");
  };
  for (const ErrorRow& row : rows) {
    std::snprintf(line, sizeof line, format, row.task.c_str(), row.rig.c_str(), row.controller.c_str(),
                  cell(row.mean_mm, "%.2f").c_str(), cell(row.std_mm, "%.2f").c_str(),
                  cell(row.rms_mm, "%.2f").c_str(), cell(row.sensed_mean_mm, "%.2f").c_str(),
                  cell(row.target_deviation_mm, "%.2f").c_str(), cell(row.time_rms_mm, "%.2f").c_str(),
                  share(row.stitches_made_share ? row.stitches_made_share : row.completion).c_str(),
                  share(row.corners_reached).c_str(), share(row.success_rate).c_str(),
                  cell(row.stopped, "%.0f").c_str(), cell(row.trials, "%.0f").c_str());
    text += line;
  }
  return text;
}

runs::DeploymentSummary merged_summary(const RunData& run) {
  runs::DeploymentSummary summary;
  for (const DeployData& rig : run.rigs)
    if (&rig == &run.rigs.front() || rig.rig == "explored")
      static_cast<runs::RigSummary&>(summary) = rig.summary;
  for (const DeployData& rig : run.rigs)
    if (run.rigs.size() > 1) summary.by_rig[rig.rig] = rig.summary;
  summary.provenance = run.provenance;
  if (run.evaluation) summary.provenance.dynamics = *run.evaluation;
  if (run.trained) summary.provenance.policy = *run.trained;
  if (run.recorded) {
    summary.provenance.collect = run.recorded;
  } else if (run.coverage) {
    runs::CollectionFacts& collect = summary.provenance.collect.emplace();
    collect.transitions_with_current = run.coverage->transitions;
    const common::Json& config = run.collect.config;
    const bool told =
        config.is_object() && config.contains("transitions") && config["transitions"].is_number_integer();
    collect.transitions = told ? config["transitions"].get<std::int64_t>() : run.coverage->transitions;
    collect.coverage = run.coverage->fraction;
    collect.evenness = run.coverage->evenness;
  }
  return summary;
}

}  // namespace lodestone::report
