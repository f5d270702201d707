#include <algorithm>
#include <map>

#include "lodestone/report/charts.h"
#include "lodestone/report/error_table.h"
#include "lodestone/report/html.h"
#include "lodestone/runs/curves.h"
#include "sections.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

std::string error_table_html(const std::vector<ErrorRow>& rows) {
  std::vector<std::vector<std::string>> cells;
  std::vector<std::string> classes;
  std::string task;
  for (const ErrorRow& row : rows) {
    const bool first = row.task != task;
    task = row.task;
    std::string name = escape(row.task);
    if (row.task == "square" && row.published) name += " (“box”)";
    cells.push_back({name, escape(row.controller), escape(row.rig),
                     plus_minus(row.mean_mm, row.std_mm, row.published ? 1 : 2), fixed(row.median_mm, 2),
                     fixed(row.rms_mm, 2), plus_minus(row.sensed_mean_mm, row.sensed_std_mm, 2),
                     fixed(row.hold_mm, 2), fixed(row.time_rms_mm, 2), fixed(row.seconds_to_reach, 1),
                     percent(row.success_rate), fixed(row.trials, 0)});
    std::string kind = row.published ? "published" : row.controller != "baseline" ? "ours" : "";
    if (first && cells.size() > 1) kind += " first";
    classes.push_back(kind);
  }
  return table({"task", "controller", "rig", "error, mean ± std (mm)", "median (mm)", "RMS (mm)",
                "as sensed, mean ± std (mm)", "holding (mm)", "RMS to moving reference (mm)", "to reach (s)",
                "success", "trials"},
               cells, 3, classes);
}

std::string bar_chart(const std::vector<ErrorRow>& rows) {
  BarChart chart;
  chart.id = "deploy-errors";
  chart.title = "Mean error by task";
  chart.x_label = "task";
  chart.y_label = "mean error (mm)";
  for (const ErrorRow& row : rows)
    if (!row.published &&
        std::find(chart.categories.begin(), chart.categories.end(), row.task) == chart.categories.end())
      chart.categories.push_back(row.task);
  const auto series = [&](const char* name, const char* colour, const std::string& controller,
                          const std::string& rig) {
    BarSeries bars;
    bars.name = name;
    bars.colour = colour;
    bool any = false;
    for (const std::string& task : chart.categories) {
      bars.values.emplace_back();
      for (const ErrorRow& row : rows)
        if (row.task == task && row.controller == controller && row.rig == rig)
          bars.values.back() = row.mean_mm;
      any = any || bars.values.back().has_value();
    }
    if (any) chart.series.push_back(bars);
  };
  std::string ours = "policy";
  for (const ErrorRow& row : rows)
    if (!row.published && row.controller != "baseline") ours = row.controller;
  series((ours + ", explored rig").c_str(), kPolicyColour, ours, "explored");
  series((ours + ", unseen rigs").c_str(), kUnseenColour, ours, "unseen");
  series("baseline, explored rig", kBaselineColour, "baseline", "explored");
  series("paper, MBS policy on the real rig", kPaperColour, "trained in an MBS", "paper");
  return chart_html(chart);
}

/// One small dish: some trials of a task by one controller.
std::string panel(const std::vector<runs::TrialRecord>& trials, const std::string& task,
                  const std::string& controller, double radius_mm, const ErrorRow* row) {
  const std::string drawing = draw_trials(trials, task, controller, radius_mm);
  if (drawing.empty()) return "";
  std::string html = "<div class=\"panel\">" + drawing + "<b>" + escape(task) + "</b>";
  if (row != nullptr)
    html +=
        "<br>" + plus_minus(row->mean_mm, row->std_mm, 1) + " mm, " + percent(row->success_rate) + " success";
  return html + "</div>";
}

std::string panels(const DeployData& deploy, const std::string& controller, const std::vector<ErrorRow>& rows,
                   double radius_mm) {
  std::string html;
  for (const char* task : runs::kTasks) {
    const ErrorRow* found = nullptr;
    for (const ErrorRow& row : rows)
      if (row.task == task && row.controller == controller && row.rig == deploy.rig) found = &row;
    html += panel(*deploy.trials, task, controller, radius_mm, found);
  }
  if (html.empty()) return "";
  return figure(
      "<div class=\"panels\">" + html + "</div>",
      "<b>" + escape(controller) + " on the " + escape(deploy.rig) +
          (deploy.rig == "unseen" ? " rigs" : " rig") + ".</b> True trajectories of up to " +
          std::to_string(kDrawnTrials) +
          " trials of each task, seen from above, with the coils drawn schematically. Rings: starts; dots: "
          "ends; green: targets with the 3 mm circle that counts as reached, or the path; grey: the way to "
          "the start of a path, which is not scored.");
}

std::string trajectories(const RunData& run, const std::vector<ErrorRow>& rows) {
  std::string html;
  for (const DeployData& deploy : run.rigs) {
    if (!deploy.trials) {
      html += missing("The list of trials on the " + deploy.rig + " rig (trials.json)", "lodestone deploy");
      continue;
    }
    const bool first = &deploy == &run.rigs.front();
    const std::string shown =
        panels(deploy, deploy.summary.controller.value_or("policy"), rows, dish_radius_mm(run)) +
        panels(deploy, "baseline", rows, dish_radius_mm(run));
    html += first ? shown
                  : "<details><summary>Trajectories on the " + escape(deploy.rig) + " rigs</summary>" +
                        shown + "</details>\n";
  }
  return html;
}

}  // namespace

std::string deployment_section(const RunData& run) {
  if (run.rigs.empty())
    return missing("The deployment",
                   "lodestone deploy --policy RUN/policy/checkpoint --task all --rig both --out RUN/deploy");
  const std::vector<ErrorRow> rows = error_rows(run);
  std::string html =
      "<p>The " + escape(run.rigs.front().summary.controller.value_or("controller")) +
      " drives the virtual rig at about 3 Hz and is scored on the rig that was explored and on "
      "rigs "
      "whose friction map and calibration error are new to it. The baseline is a proportional pull through "
      "the inverse "
      "field of the plain simulator. Errors are against the true pose unless they say <i>as sensed</i>: for "
      "centre and "
      "point the distance at the end of a trial, for paths the cross-track error of every sample after the "
      "approach. "
      "The paper's figures (Table II, italic) come from the real rig.</p>\n" +
      error_table_html(rows);
  html += figure(bar_chart(rows),
                 "<b>Mean error by task.</b> Lower is better. Grey: the paper's policy trained in "
                 "its own learned simulator, on its real rig.");
  return html + trajectories(run, rows);
}

std::string recorded_section(const RunData& run, const RunData& recorded) {
  std::string html =
      "<p>The same two steps on recordings of a real rig: a magnetic sphere on a four-coil device, one coil "
      "at a time. "
      "Its state is a position without a heading, so errors are comparable in kind, not in size.</p>\n";
  const auto row = [](const char* name, const RunData& r) -> std::vector<std::string> {
    const Curve success = curve(r.policy.metrics, runs::curves::kSuccess);
    const Curve error = curve(r.policy.metrics, runs::curves::kFinalError);
    std::vector<std::string> cells = {name, "–", "–", "–", "–"};
    if (r.evaluation) {
      if (r.evaluation->n) cells[1] = grouped(static_cast<double>(*r.evaluation->n));
      cells[2] = fixed(r.evaluation->one_step.position_rms_mm, 3);
      if (r.evaluation->baselines) {
        cells[3] = fixed(r.evaluation->baselines->nearest_neighbours.position_rms_mm, 3);
        cells[4] = fixed(r.evaluation->baselines->no_motion.position_rms_mm, 3);
      }
    }
    cells.push_back(success.empty() ? "–" : percent(success.back().second));
    cells.push_back(error.empty() ? "–" : fixed(error.back().second, 2));
    return cells;
  };
  html += table({"trained on", "test pulses", "simulator (mm RMS)", "ten neighbours (mm RMS)",
                 "no motion (mm RMS)", "policy success in its simulator", "final error there (mm)"},
                {row("virtual rig, needle", run), row("real recordings, sphere", recorded)}, 1);
  html +=
      "<h3>Simulator learned from the recordings</h3>\n" + dynamics_section(recorded, "recorded-dynamics");
  html += "<h3>Policy trained in it</h3>\n" + policy_section(recorded, "recorded-policy");
  return html;
}

}  // namespace lodestone::report
