#include "lodestone/report/rigs_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"
#include "lodestone/runs/rigs_result.h"

namespace lodestone::report {
namespace {

using runs::RigFigures;
using runs::RigsTaskSummary;

const char* colour_of(const std::string& controller) {
  if (controller == "baseline") return kBaselineColour;
  if (controller == "observer") return kObserverColour;
  if (controller.rfind("adapted_", 0) == 0) return kSecondColour;
  if (controller.rfind("from_scratch_", 0) == 0) return kPaperColour;
  return controller == "policy" ? kUnseenColour : kPolicyColour;
}

const std::vector<std::string>& headings() {
  static const std::vector<std::string> kHeadings = {"task",
                                                     "controller",
                                                     "error (mm)",
                                                     "success",
                                                     "moving reference (mm)",
                                                     "corners within 1.5 mm",
                                                     "heading RMS (degrees)",
                                                     "worst rig (mm)",
                                                     "against the baseline (mm)",
                                                     "against identified only (mm)",
                                                     "stopped",
                                                     "trials"};
  return kHeadings;
}

std::vector<std::string> row_of(const std::string& task, const std::string& controller,
                                const RigsTaskSummary& summary) {
  const runs::ErrorStatistics& errors = summary.truth ? *summary.truth : summary.sensed;
  return {
      task,
      controller,
      with_interval(errors.mean_error_mm, summary.mean_error_interval_mm, 2, 1.0, ""),
      with_interval(errors.success_rate, summary.success_interval, 1, 100.0, " %"),
      with_interval(errors.time_rms_error_mm, summary.time_rms_error_interval_mm, 2, 1.0, ""),
      with_interval(summary.corners_within_1_5_mm, summary.corners_within_1_5_mm_interval, 1, 100.0, " %"),
      with_interval(errors.heading_rms_deg, summary.heading_rms_interval_deg, 1, 1.0, ""),
      fixed(summary.worst.mean_error_mm, 2) + ", rig " + std::to_string(summary.worst.rig),
      with_interval(summary.minus_baseline_mm, summary.minus_baseline_interval_mm, 2, 1.0, ""),
      with_interval(summary.minus_planner_mm, summary.minus_planner_interval_mm, 3, 1.0, ""),
      std::to_string(summary.stopped),
      std::to_string(summary.n_trials)};
}

std::vector<std::vector<std::string>> rows_of(const runs::RigsSummary& summary) {
  std::vector<std::vector<std::string>> rows;
  for (const char* task : runs::kTasks)
    for (const std::string& controller : summary.controllers()) {
      const auto of_controller = summary.by_controller.find(controller);
      if (of_controller == summary.by_controller.end()) continue;
      const auto of_task = of_controller->second.find(task);
      if (of_task != of_controller->second.end()) rows.push_back(row_of(task, controller, of_task->second));
    }
  return rows;
}

std::string text_of(const std::vector<std::vector<std::string>>& rows) {
  std::size_t widest = 9;
  for (const auto& row : rows) widest = std::max(widest, row[1].size());
  std::string text;
  for (const auto& row : rows) {
    text += fmt::format("{:<7} {:<{}} error {} mm, success {}", row[0], row[1], widest, row[2], row[3]);
    if (row[4] != "–") text += ", moving reference " + row[4] + " mm";
    if (row[5] != "–") text += ", corners within 1.5 mm " + row[5];
    if (row[6] != "–") text += ", heading " + row[6] + " degrees";
    text += "; worst rig " + row[7];
    if (row[8] != "–") text += "; against the baseline " + row[8] + " mm";
    if (row[9] != "–") text += "; against identified only " + row[9] + " mm";
    text += "; " + row[10] + " of " + row[11] + " trials stopped\n";
  }
  return text;
}

/// Something hidden in a rig.
struct Parameter {
  const char* id;
  const char* label;
  double (*of)(const RigFigures& rig);
};

const std::vector<Parameter>& parameters() {
  static const std::vector<Parameter> kParameters = {
      {"strength", "moment × coil gain / (friction × weight)",
       [](const RigFigures& rig) {
         return rig.moment * rig.coil_gain / (rig.friction * rig.weight.value_or(1.0));
       }},
      {"moment", "moment of the needle", [](const RigFigures& rig) { return rig.moment; }},
      {"friction", "friction", [](const RigFigures& rig) { return rig.friction; }},
      {"weight", "weight of the needle", [](const RigFigures& rig) { return rig.weight.value_or(1.0); }},
      {"viscosity", "viscosity", [](const RigFigures& rig) { return rig.viscosity; }},
      {"gain", "mean gain of the coils", [](const RigFigures& rig) { return rig.coil_gain; }}};
  return kParameters;
}

/// Nothing to be drawn against.
bool same_everywhere(const runs::RigsResult& result, const Parameter& parameter) {
  return std::all_of(result.rigs.begin(), result.rigs.end(), [&](const RigFigures& rig) {
    return parameter.of(rig) == parameter.of(result.rigs.front());
  });
}

std::string scatter(const runs::RigsResult& result, const std::string& task, const Parameter& parameter) {
  LineChart chart{task + "-" + parameter.id, task, std::string(parameter.label) + " (factor)", "error (mm)"};
  chart.small = true;
  chart.from_zero = true;
  for (const char* controller : runs::kControllers) {  // what was learned has charts of its own
    LineSeries series{controller, {}, colour_of(controller)};
    series.dots = true;
    for (const RigFigures& rig : result.rigs) {
      const auto of_controller = rig.mean_error_mm.find(controller);
      if (of_controller == rig.mean_error_mm.end()) continue;
      const auto error = of_controller->second.find(task);
      if (error != of_controller->second.end()) series.points.emplace_back(parameter.of(rig), error->second);
    }
    if (!series.points.empty()) chart.series.push_back(std::move(series));
  }
  return chart.series.empty() ? "" : "<div class=\"panel\">" + chart_html(chart) + "</div>";
}

/// Mean errors of planners that learned their rigs, by the minutes that it took, and a line for each way of
/// learning: an adaptation begins where rigs are only identified.
std::string curve(const runs::RigsSummary& summary, const std::string& task) {
  LineChart chart{task + "-minutes", task, "pulses on the rig before (minutes)", "error (mm)"};
  chart.small = true;
  chart.from_zero = true;
  for (const char* kind : {"adapted", "from_scratch"}) {
    LineSeries series{kind, {}, colour_of(kind + std::string("_"))}, low, high;
    const auto add = [&](const std::string& controller, double minutes) {
      const auto of_controller = summary.by_controller.find(controller);
      if (of_controller == summary.by_controller.end()) return;
      const auto of_task = of_controller->second.find(task);
      if (of_task == of_controller->second.end()) return;
      const RigsTaskSummary& figures = of_task->second;
      series.points.emplace_back(minutes, (figures.truth ? *figures.truth : figures.sensed).mean_error_mm);
      low.points.emplace_back(minutes, figures.mean_error_interval_mm[0]);
      high.points.emplace_back(minutes, figures.mean_error_interval_mm[1]);
    };
    if (kind == std::string("adapted")) add("planner", 0.0);
    for (const std::string& controller : summary.controllers())
      if (controller.rfind(kind, 0) == 0) add(controller, summary.learned.at(controller).rig_minutes);
    if (series.points.empty()) continue;
    for (LineSeries* edge : {&low, &high}) {
      edge->band = true;
      edge->colour = series.colour;
      chart.series.push_back(*edge);
    }
    chart.series.push_back(std::move(series));
  }
  return chart.series.empty() ? "" : "<div class=\"panel\">" + chart_html(chart) + "</div>";
}

std::string text_of(const std::map<std::string, runs::LearnedRigs>& learned) {
  std::string text;
  for (const auto& [name, rigs] : learned)
    text += fmt::format("{}: {} rigs, {:.1f} minutes of each{}, {} placements, {:.0f} s of computing\n", name,
                        rigs.rigs, rigs.rig_minutes,
                        name.rfind("adapted_", 0) == 0 ? fmt::format(", kept on {}", rigs.kept) : "",
                        rigs.placements, rigs.median_seconds);
  return text;
}

}  // namespace

std::string write_rigs_report(const std::string& folder, const std::string& out) {
  const auto summary = common::read_artefact<runs::RigsSummary>(folder + "/" + runs::RigsSummary::kFile);
  const auto result = common::read_artefact<runs::RigsResult>(folder + "/" + runs::RigsResult::kFile);
  const auto rows = rows_of(summary);
  std::vector<std::string> shown_headings = headings();
  std::vector<std::vector<std::string>> shown_rows = rows;
  drop_empty_columns(shown_headings, shown_rows);
  HtmlPage page("Controllers on " + std::to_string(summary.rigs) + " rigs",
                std::to_string(summary.trials_per_rig) + " trials of a task on each, " +
                    (summary.decorated ? "with decorators" : "as configured"));
  page.add_section(
      "table", "In numbers",
      figure(table(shown_headings, shown_rows, 2),
             "<b>Errors over rigs that nobody has seen</b>: of points the distance at the end, of paths the "
             "cross-track RMS. Intervals of 95 % by drawing rigs anew. Every controller has the same rigs, "
             "starts and targets; against the baseline: below zero is better than it."));
  if (!summary.learned.empty()) {
    std::string charts;
    for (const char* task : runs::kTasks) charts += curve(summary, task);
    page.add_section(
        "learned", "Against the minutes that each rig was learned for",
        figure("<div class=\"panels wide\">" + charts + "</div>",
               "At 0 rigs are only identified while they are driven. <i>adapted</i>: the simulator went on "
               "learning from pulses of the rig; <i>from_scratch</i>: it began with them. Shaded: 95 % by "
               "drawing "
               "rigs anew.") +
            "<pre>" + text_of(summary.learned) + "</pre>");
  }
  for (const Parameter& parameter : parameters()) {
    if (same_everywhere(result, parameter)) continue;
    std::string charts;
    for (const char* task : runs::kTasks) charts += scatter(result, task, parameter);
    page.add_section(parameter.id, "Against the " + std::string(parameter.label),
                     figure("<div class=\"panels wide\">" + charts + "</div>",
                            "A dot is the mean error on one rig; the factor is on what its description says, "
                            "and no controller was told."));
  }
  common::write_file_atomically(out, page.render());
  return text_of(rows) + text_of(summary.learned);
}

}  // namespace lodestone::report
