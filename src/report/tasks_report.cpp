#include "lodestone/report/tasks_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"
#include "lodestone/runs/rigs_result.h"
#include "lodestone/runs/tasks_result.h"

namespace lodestone::report {
namespace {

using runs::TaskDrivers;
using runs::TaskFigures;
using TableRows = std::vector<std::vector<std::string>>;

constexpr const char* kSquares = "square_at_mm_s";
constexpr double kStillShown = 3.0;  // a limit, up to so many times the fastest square
constexpr const char* kArounds[] = {"bare", "decorated"};

std::vector<std::string> task_columns() {
  return {"task",
          "controller",
          "around it",
          "error (mm)",
          "RMS error (mm)",
          "moving reference (mm)",
          "heading at the end (degrees)",
          "heading RMS (degrees)",
          "success",
          "without any way",
          "success where there is a way",
          "touched an obstacle",
          "error / that in fluid at rest",
          "error / the baseline's",
          "error / the oracle's",
          "stopped",
          "trials"};
}

std::vector<std::string> task_row(const std::string& task, const std::string& controller,
                                  const std::string& around, const TaskFigures& figures) {
  const runs::ErrorStatistics& errors = figures.errors();
  return {task,
          controller,
          around,
          with_interval(errors.mean_error_mm, figures.mean_error_interval_mm, 2),
          with_interval(errors.rms_error_mm, figures.rms_error_interval_mm, 2),
          with_interval(errors.time_rms_error_mm, figures.time_rms_error_interval_mm, 2),
          with_interval(errors.heading_error_deg, figures.heading_error_interval_deg, 1),
          with_interval(errors.heading_rms_deg, figures.heading_rms_interval_deg, 1),
          with_interval(errors.success_rate, figures.success_interval, 1, 100.0, " %"),
          with_interval(figures.unreachable_rate, figures.unreachable_interval, 1, 100.0, " %"),
          with_interval(figures.reachable_success_rate, figures.reachable_success_interval, 1, 100.0, " %"),
          with_interval(errors.touching_rate, errors.touching_interval, 1, 100.0, " %"),
          with_interval(figures.ratio_to_still, figures.ratio_to_still_interval, 2),
          with_interval(figures.ratio_to_baseline, figures.ratio_to_baseline_interval, 2),
          with_interval(figures.ratio_to_oracle, figures.ratio_to_oracle_interval, 2),
          std::to_string(figures.stopped),
          std::to_string(figures.n_trials)};
}

void add_task_rows(const std::string& task, const TaskDrivers& drivers, TableRows& rows) {
  for (const char* controller : runs::kDrivers)
    for (const char* around : kArounds) {
      const auto of_controller = drivers.find(controller);
      if (of_controller == drivers.end() || of_controller->second.count(around) == 0) continue;
      rows.push_back(task_row(task, controller, around, of_controller->second.at(around)));
    }
}

TableRows task_rows(const runs::TasksSummary& summary) {
  TableRows rows;
  for (const char* task : runs::TasksSummary::kAlone)
    if (const auto found = summary.alone.find(task); found != summary.alone.end())
      add_task_rows(task, found->second, rows);
  for (const char* group : runs::TasksSummary::kGroups)
    if (const auto found = summary.groups.find(group); found != summary.groups.end())
      for (const auto& [name, drivers] : found->second)
        add_task_rows(std::string(group) + " " + name, drivers, rows);
  return rows;
}

/// A line a row: of a figure what it is called, and its number.
std::string text_of_tasks(const TableRows& rows) {
  const std::vector<std::string> columns = task_columns();
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    text += fmt::format("{:<20} {:<9} {:<9}", row[0], row[1], row[2]);
    const char* before = " ";
    for (std::size_t column = 3; column < row.size(); ++column) {
      if (row[column] == "–") continue;
      text += before + columns[column] + ": " + row[column];
      before = "; ";
    }
    text += "\n";
  }
  return text;
}

const char* task_colour(const std::string& controller) {
  if (controller == "baseline") return kBaselineColour;
  return controller == "policy" ? kUnseenColour : kPolicyColour;
}

/// Errors along a square by the speed of its reference; empty where there are none.
std::string speed_figure(const runs::TasksSummary& summary) {
  const auto squares = summary.groups.find(kSquares);
  if (squares == summary.groups.end()) return "";
  LineChart chart{"square-speed", "", "speed of the reference (mm/s)", "error (mm)"};
  chart.from_zero = true;
  for (const char* controller : runs::kDrivers)
    for (const char* around : kArounds) {
      LineSeries series{std::string(controller) + ", " + around, {}, task_colour(controller)};
      series.dashed = around == std::string("decorated");
      for (const auto& [speed_mm_s, drivers] : squares->second) {
        const auto of_controller = drivers.find(controller);
        if (of_controller == drivers.end() || of_controller->second.count(around) == 0) continue;
        series.points.emplace_back(std::stod(speed_mm_s),
                                   of_controller->second.at(around).errors().mean_error_mm);
      }
      if (!series.points.empty()) chart.series.push_back(std::move(series));
    }
  if (chart.series.empty()) return "";
  std::string limit;
  if (summary.square_speed_limit_m_s) {
    double most_mm = 0.0, fastest_mm_s = 0.0;
    for (const LineSeries& series : chart.series)
      for (const auto& [speed_mm_s, error_mm] : series.points) {
        fastest_mm_s = std::max(fastest_mm_s, speed_mm_s);
        most_mm = std::max(most_mm, error_mm);
      }
    const double limit_mm_s = geometry::kMmPerM * *summary.square_speed_limit_m_s;
    const bool drawn = limit_mm_s < kStillShown * fastest_mm_s;
    if (drawn)
      chart.series.push_back(
          {"as fast as physics allows", {{limit_mm_s, 0.0}, {limit_mm_s, most_mm}}, kSecondColour});
    limit = fmt::format(
        " Physics allows at least {:.0f} mm/s ({}): what a full pulse moves a needle in a control period, by "
        "the "
        "description of the rig, where on the first half of a side that is least.",
        limit_mm_s,
        drawn ? "drawn in" : "far to the right of what is drawn: it is not strength that is lacking");
  }
  return figure(chart_html(chart),
                "<b>A square at several speeds.</b> Mean over the trials of the "
                "cross-track RMS; dashed: decorated." +
                    limit);
}

}  // namespace

std::string write_tasks_report(const std::string& folder, const std::string& out) {
  const auto summary = common::read_artefact<runs::TasksSummary>(folder + "/" + runs::TasksSummary::kFile);
  const TableRows rows = task_rows(summary);
  const std::string finished =
      fmt::format("{} of {} cells are finished", summary.cells, summary.cells_planned);
  HtmlPage page("Beyond points", finished);
  std::vector<std::string> shown_columns = task_columns();
  TableRows shown_rows = rows;
  drop_empty_columns(shown_columns, shown_rows);
  const std::string flow =
      summary.flow_speed_m_s
          ? fmt::format(
                " The flow rises and falls as a sine once a second, {:.1f} mm/s in the mean; at its peak "
                "its drag on a needle that lies across it is half of what friction holds.",
                1e3 * *summary.flow_speed_m_s)
          : "";
  const auto by_oracle = [](const TableRows::value_type& row) { return row[1] == runs::kOracle; };
  const std::string oracle = std::any_of(rows.begin(), rows.end(), by_oracle)
                                 ? " The oracle is a planner that knows all that is hidden in the rig and "
                                   "where the needle really is: "
                                   "no controller, but shows what a wrong model and pose cost. Its search is "
                                   "less wide than the planner's. "
                                   "It drove the first of the "
                                   "trials."
                                 : "";
  page.add_section(
      "table", "In numbers",
      figure(
          table(shown_columns, shown_rows, 3),
          "<b>Each trial is on a rig of its own that nobody has seen.</b> Every controller has the same "
          "rigs, "
          "starts and targets. Error: of points and poses the distance at the end, of paths the cross-track "
          "RMS of a trial. Intervals of 95 %: Wilson's of shares, else by drawing trials anew." +
              oracle + flow));
  if (const std::string speeds = speed_figure(summary); !speeds.empty())
    page.add_section("speed", "Error against speed", speeds);
  common::write_file_atomically(out, page.render());
  return finished + "\n" + text_of_tasks(rows);
}

}  // namespace lodestone::report
