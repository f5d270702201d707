#include "lodestone/experiments/tasks_summary.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/score.h"
#include "lodestone/experiments/speed_limit.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::experiments {
namespace {

using Bounds = std::array<double, 2>;
using TrialFigure = std::optional<double> runs::TrialFigures::*;

Bounds bounds_of(const common::Interval& interval) { return {interval.low, interval.high}; }

Bounds drawn_anew(const std::vector<double>& values,
                  const std::function<double(const std::vector<double>&)>& statistic,
                  const std::string& what) {
  return bounds_of(common::bootstrap_interval({values}, statistic, common::RandomStream(1, "tasks/" + what)));
}

/// Of the mean of a figure over the trials that have it.
std::optional<Bounds> mean_bounds(const std::vector<runs::TrialRecord>& trials, TrialFigure figure,
                                  const std::string& what) {
  std::vector<double> values;
  for (const runs::TrialRecord& trial : trials)
    if (const std::optional<double>& value = trial.figures().*figure) values.push_back(*value);
  if (values.empty()) return std::nullopt;
  return drawn_anew(values, common::mean, what);
}

std::vector<double> errors_mm_of(const std::vector<runs::TrialRecord>& trials) {
  std::vector<double> errors_mm;
  for (const runs::TrialRecord& trial : trials) errors_mm.push_back(trial.figures().error_mm());
  return errors_mm;
}

/// What became of layouts that were drawn for each trial.
void note_layouts(const std::vector<runs::TrialRecord>& trials, runs::TaskFigures& figures) {
  std::int64_t layouts = 0, unreachable = 0, reached = 0;
  for (const runs::TrialRecord& trial : trials) {
    if (!trial.unreachable) continue;
    ++layouts;
    if (*trial.unreachable)
      ++unreachable;
    else if (trial.figures().success)
      ++reached;
  }
  if (layouts == 0) return;
  const std::int64_t reachable = layouts - unreachable;
  figures.unreachable_rate = static_cast<double>(unreachable) / static_cast<double>(layouts);
  figures.unreachable_interval = bounds_of(common::wilson_interval(unreachable, layouts));
  if (reachable == 0) return;
  figures.reachable_success_rate = static_cast<double>(reached) / static_cast<double>(reachable);
  figures.reachable_success_interval = bounds_of(common::wilson_interval(reached, reachable));
}

/// Of a cell: the task's name, who drove, and "bare" or "decorated".
struct CellName {
  std::string task, controller, around;
};

CellName name_of_cell(const std::string& id) {
  const std::size_t last = id.rfind('/');
  const std::size_t before = last == std::string::npos || last == 0 ? last : id.rfind('/', last - 1);
  LODESTONE_CHECK(before != std::string::npos && before > 0,
                  "a cell's id: task, controller, what is around it");
  return {id.substr(0, before), id.substr(before + 1, last - before - 1), id.substr(last + 1)};
}

runs::TaskDrivers& drivers_of(runs::TasksSummary& summary, const std::string& task) {
  const std::size_t slash = task.find('/');
  if (slash == std::string::npos) return summary.alone[task];
  return summary.groups[task.substr(0, slash)][task.substr(slash + 1)];
}

/// Quotient of two mean errors over the same trials, the first ones where one has more, and its interval;
/// nothing where those were not driven.
void compare_errors(const std::vector<double>& errors_mm, const std::vector<double>* others_mm,
                    const std::string& what, std::optional<double>& ratio, std::optional<Bounds>& interval) {
  if (others_mm == nullptr || others_mm->empty() || common::mean(*others_mm) <= 0.0) return;
  std::vector<double> trials;  // are drawn, so that pairs stay pairs
  for (std::size_t i = 0; i < std::min(errors_mm.size(), others_mm->size()); ++i)
    trials.push_back(static_cast<double>(i));
  const auto quotient = [&](const std::vector<double>& drawn) {
    double sum_mm = 0.0, others_sum_mm = 0.0;
    for (const double trial : drawn) {
      sum_mm += errors_mm[static_cast<std::size_t>(trial)];
      others_sum_mm += (*others_mm)[static_cast<std::size_t>(trial)];
    }
    return sum_mm / others_sum_mm;
  };
  ratio = quotient(trials);
  interval = drawn_anew(trials, quotient, what);
}

/// Mean flow of a cell with one, m/s.
std::optional<double> flow_speed_of(const runs::Cell& cell) {
  const std::string key = "rig.simulation.flow.speed_m_s=";
  for (const std::string& setting : cell.settings)
    if (setting.rfind(key, 0) == 0) return std::stod(setting.substr(key.size()));
  return std::nullopt;
}

}  // namespace

runs::TaskFigures task_figures(const std::vector<runs::TrialRecord>& trials) {
  LODESTONE_CHECK(!trials.empty(), "at least one trial of a task");
  runs::TaskFigures figures;
  static_cast<runs::TaskSummary&>(figures) = summarise_task(trials);
  std::int64_t successes = 0;
  for (const runs::TrialRecord& trial : trials) successes += trial.figures().success ? 1 : 0;
  figures.success_interval =
      bounds_of(common::wilson_interval(successes, static_cast<std::int64_t>(trials.size())));
  const std::vector<double> errors_mm = errors_mm_of(trials);
  figures.mean_error_interval_mm = drawn_anew(errors_mm, common::mean, "error");
  figures.rms_error_interval_mm = drawn_anew(errors_mm, common::root_mean_square, "rms");
  using Figures = runs::TrialFigures;
  figures.time_rms_error_interval_mm = mean_bounds(trials, &Figures::time_rms_error_mm, "time");
  figures.heading_rms_interval_deg = mean_bounds(trials, &Figures::heading_rms_deg, "heading rms");
  figures.heading_error_interval_deg = mean_bounds(trials, &Figures::heading_error_deg, "heading");
  note_layouts(trials, figures);
  return figures;
}

runs::TasksSummary summarise_tasks(const runs::Plan& plan, const runs::PlanPlace& place,
                                   const physics::RigDescription& rig) {
  runs::TasksSummary summary;
  summary.cells_planned = static_cast<std::int64_t>(plan.cells.size());
  std::map<std::string, std::vector<double>> errors_mm;  // of finished cells
  for (const runs::Cell& cell : plan.cells) {
    if (const auto speed_m_s = flow_speed_of(cell)) summary.flow_speed_m_s = speed_m_s;
    const std::string folder = runs::cell_folder(plan, place, cell.id);
    const auto state = runs::find_run(folder);
    if (!state || !state->finished) continue;
    const auto trials = runs::find_trials(folder);
    if (!trials || trials->empty()) continue;
    ++summary.cells;
    errors_mm[cell.id] = errors_mm_of(*trials);
    const CellName name = name_of_cell(cell.id);
    drivers_of(summary, name.task)[name.controller][name.around] = task_figures(*trials);
  }
  for (const auto& [id, own_mm] : errors_mm) {
    const CellName name = name_of_cell(id);
    runs::TaskFigures& figures = drivers_of(summary, name.task)[name.controller][name.around];
    const auto errors_of = [&errors_mm](const std::string& other) {
      const auto found = errors_mm.find(other);
      return found == errors_mm.end() ? nullptr : &found->second;
    };
    const std::string of_flow = "flow/";
    if (name.task.rfind(of_flow, 0) == 0)
      compare_errors(
          own_mm,
          errors_of("still/" + name.task.substr(of_flow.size()) + "/" + name.controller + "/" + name.around),
          "still", figures.ratio_to_still, figures.ratio_to_still_interval);
    if (name.controller != "baseline")
      compare_errors(own_mm, errors_of(name.task + "/baseline/" + name.around), "baseline",
                     figures.ratio_to_baseline, figures.ratio_to_baseline_interval);
    if (name.controller != runs::kOracle)
      compare_errors(own_mm, errors_of(name.task + "/" + runs::kOracle + "/bare"), "oracle",
                     figures.ratio_to_oracle, figures.ratio_to_oracle_interval);
  }
  // A square in fluid at rest is followed at 2 mm/s.
  const auto still = summary.groups.find("still");
  if (still != summary.groups.end() && still->second.count("square") > 0) {
    const runs::TaskDrivers slow = still->second.at("square");
    summary.groups["square_at_mm_s"]["2"] = slow;
  }
  if (summary.groups.count("square_at_mm_s") > 0)
    summary.square_speed_limit_m_s =
        square_speed_limit_m_s(rig, TrialsConfig{}.square_side_m, control::ControlLoopConfig{});
  return summary;
}

}  // namespace lodestone::experiments
