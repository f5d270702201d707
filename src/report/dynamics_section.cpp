#include <algorithm>
#include <cmath>
#include <tuple>

#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"
#include "lodestone/runs/curves.h"
#include "sections.h"

namespace lodestone::report {
namespace {

// Colours of the error map end here, so that a few bad cells do not flatten the rest.
constexpr double kMapQuantile = 0.97;

/// Whether likelihood was learned: then that is what training and validation tell of, and no distance.
bool learned_likelihood(const RunData& run) {
  const common::Json::json_pointer components("/model/components");
  const common::Json& config = run.dynamics.config;
  return config.is_object() && config.contains(components) && config.at(components).is_number() &&
         config.at(components).get<double>() > 0.0;
}

std::string learning_curve(const RunData& run, const std::string& prefix) {
  LineChart chart{prefix + "-loss", "Loss during training", "epoch",
                  learned_likelihood(run) ? "negative log-likelihood" : "normalised loss"};
  const Curve train = curve(run.dynamics.metrics, runs::curves::kTrainLoss);
  const Curve validation = curve(run.dynamics.metrics, runs::curves::kValidationLoss);
  const auto positive = [](const auto& point) { return point.second > 0.0; };
  if (std::none_of(train.begin(), train.end(), positive) &&
      std::none_of(validation.begin(), validation.end(), positive))
    return "";
  // A likelihood may go below zero: a logarithmic axis then cannot show it.
  chart.log_y = std::all_of(train.begin(), train.end(), positive) &&
                std::all_of(validation.begin(), validation.end(), positive);
  chart.series = {{"training", train, kPolicyColour}, {"validation", validation, kBaselineColour}};
  return figure(chart_html(chart),
                "<b>Learning curve.</b> Loss on the rows trained on and on episodes kept aside. A "
                "validation curve that turns upwards would mean memorising.");
}

/// Position errors over the number of pulses.
Curve position_errors(const runs::OpenLoopError& error) {
  Curve points;
  if (error.k_step_mm)
    for (const auto& [steps, rms_mm] : *error.k_step_mm)
      if (rms_mm) points.emplace_back(steps, *rms_mm);
  return points;
}

std::string open_loop(const runs::DynamicsEvaluation& evaluation, const std::string& prefix) {
  LineChart chart{prefix + "-open-loop", "Error without correction", "pulses predicted ahead",
                  "position error (mm RMS)"};
  chart.from_zero = true;
  const Curve points = position_errors(evaluation.open_loop);
  if (points.size() < 2) return "";
  chart.series.push_back({"learned simulator", points, kPolicyColour});
  const auto level = [&](const runs::StateError& error, const char* name, const char* colour) {
    chart.series.push_back(
        {name,
         {{points.front().first, error.position_rms_mm}, {points.back().first, error.position_rms_mm}},
         colour,
         true});
  };
  std::string caption =
      "<b>Open-loop error.</b> The simulator is fed its own prediction for several pulses in a row.";
  if (evaluation.baselines) {
    const runs::DynamicsBaselines& baselines = *evaluation.baselines;
    level(baselines.no_motion, "no motion, one pulse", kPaperColour);
    if (baselines.nearest_neighbours_open_loop) {
      const Curve theirs = position_errors(*baselines.nearest_neighbours_open_loop);
      chart.series.push_back({"ten nearest neighbours", theirs, kBaselineColour});
      caption += " So are the nearest neighbours. Dashed: what no motion misses after a single pulse.";
    } else {
      level(baselines.nearest_neighbours, "ten nearest neighbours, one pulse", kBaselineColour);
      caption += " Dashed lines: what the two baselines miss after a single pulse.";
    }
  }
  return figure(chart_html(chart), caption);
}

/// Points of one axis: what was predicted over what happened.
LineSeries predicted_axis(const std::vector<runs::PredictedMotion>& predictions, std::size_t axis,
                          const char* name, const char* colour) {
  LineSeries series{name, {}, colour};
  series.dots = true;
  for (const runs::PredictedMotion& one : predictions)
    series.points.emplace_back(one.moved_mm[axis], one.predicted_mm[axis]);
  return series;
}

std::string predicted_against_actual(const runs::DynamicsEvaluation& evaluation, const std::string& prefix) {
  if (!evaluation.predictions || evaluation.predictions->empty()) return "";
  LineChart chart{prefix + "-predicted", "Predicted against actual", "way of the needle in one pulse (mm)",
                  "way predicted (mm)"};
  chart.series = {predicted_axis(*evaluation.predictions, 0, "along x", kPolicyColour),
                  predicted_axis(*evaluation.predictions, 1, "along y", kBaselineColour)};
  double low = 0.0;
  double high = 0.0;
  for (const LineSeries& series : chart.series)
    for (const auto& [moved, predicted] : series.points) {
      low = std::min({low, moved, predicted});
      high = std::max({high, moved, predicted});
    }
  chart.series.push_back({"as it was", {{low, low}, {high, high}}, kPaperColour, true});
  return figure(
      chart_html(chart),
      "<b>Predicted against actual.</b> Some of the test pulses, evenly taken. On the dashed line the "
      "prediction is right; a cloud flatter than the line promises too little motion.");
}

std::string error_rows_html(const runs::DynamicsEvaluation& evaluation) {
  const bool heading = evaluation.one_step.heading_rms_deg.has_value();
  std::vector<std::string> headers = {"prediction of the next state", "position (mm RMS)", "of no motion"};
  if (heading) headers.insert(headers.begin() + 2, "heading (° RMS)");
  const double still_mm = evaluation.baselines ? evaluation.baselines->no_motion.position_rms_mm : 0.0;
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const runs::StateError& error) {
    std::vector<std::string> row = {name, fixed(error.position_rms_mm, 3)};
    if (heading) row.push_back(fixed(error.heading_rms_deg, 2));
    row.push_back(still_mm > 0.0 ? percent(error.position_rms_mm / still_mm) : "–");
    rows.push_back(row);
  };
  add("learned simulator", evaluation.one_step);
  if (evaluation.baselines) {
    add("ten nearest neighbours", evaluation.baselines->nearest_neighbours);
    add("no motion", evaluation.baselines->no_motion);
  }
  return table(headers, rows, 1, {"strong"});
}

/// Errors by the number of pulses, those of the baselines below, which older runs do not tell.
std::string open_loop_rows_html(const runs::DynamicsEvaluation& evaluation) {
  if (!evaluation.open_loop.k_step_mm || evaluation.open_loop.k_step_mm->empty()) return "";
  const runs::OpenLoopError::BySteps& steps = *evaluation.open_loop.k_step_mm;
  std::vector<std::string> headers = {"pulses ahead"};
  for (const auto& entry : steps) headers.push_back(std::to_string(entry.first));
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const std::optional<runs::OpenLoopError::BySteps>& errors,
                       int decimals) {
    if (!errors) return;
    std::vector<std::string>& row = rows.emplace_back(1, name);
    for (const auto& entry : steps) {
      const auto found = errors->find(entry.first);
      row.push_back(fixed(found == errors->end() ? std::nullopt : found->second, decimals));
    }
  };
  runs::OpenLoopError neighbours, still;
  if (evaluation.baselines) {
    neighbours = evaluation.baselines->nearest_neighbours_open_loop.value_or(runs::OpenLoopError{});
    still = evaluation.baselines->no_motion_open_loop.value_or(runs::OpenLoopError{});
  }
  add("position error (mm RMS)", evaluation.open_loop.k_step_mm, 2);
  add("of ten nearest neighbours", neighbours.k_step_mm, 2);
  add("of no motion", still.k_step_mm, 2);
  add("heading error (° RMS)", evaluation.open_loop.k_step_heading_deg, 1);
  add("of ten nearest neighbours", neighbours.k_step_heading_deg, 1);
  add("of no motion", still.k_step_heading_deg, 1);
  return table(headers, rows, 1);
}

/// How many pulses ended where they were expected to, region by region; empty where none were predicted.
std::string coverage_html(const runs::DynamicsEvaluation& evaluation) {
  if (!evaluation.region_coverage || evaluation.region_coverage->position.empty()) return "";
  const runs::RegionCoverage& coverage = *evaluation.region_coverage;
  std::vector<std::string> headers = {"inside the region that should hold (95 % interval)"};
  for (const auto& entry : coverage.position) headers.push_back(std::to_string(entry.first) + " %");
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const runs::RegionCoverage::ByPercent& shares) {
    std::vector<std::string>& row = rows.emplace_back(1, name);
    for (const auto& entry : shares) {
      const runs::CoveredFraction& covered = entry.second;
      row.push_back(fixed(100.0 * covered.fraction, 1) + " % (" + fixed(100.0 * covered.interval[0], 1) +
                    " to " + fixed(100.0 * covered.interval[1], 1) + ")");
    }
  };
  add("position", coverage.position);
  if (coverage.pose) add("position and heading", *coverage.pose);
  return table(headers, rows, 1);
}

std::string metrics_table(const runs::DynamicsEvaluation& evaluation, bool likelihood) {
  std::string html =
      error_rows_html(evaluation) + open_loop_rows_html(evaluation) + coverage_html(evaluation);
  std::vector<std::vector<std::string>> losses;
  const auto loss = [&](const char* name, const std::optional<double>& value, const char* paper) {
    if (value) losses.push_back({name, fixed(value, 4), paper});
  };
  if (evaluation.training) {
    const auto& [of_training, of_validation, paper] =
        likelihood ? std::tuple{"training, negative log-likelihood", "validation, likewise", "–"}
                   : std::tuple{"training", "validation", "0.033"};
    loss(of_training, evaluation.training->train_loss, "–");
    loss(of_validation, evaluation.training->validation_loss, paper);
  }
  loss("test", evaluation.normalised_l2, "0.045");
  loss("test, next state instead of change", evaluation.normalised_state_l2, "–");
  if (!losses.empty()) html += table({"normalised loss", "this run", "paper"}, losses, 1);
  return html;
}

std::string error_map(const RunData& run) {
  std::vector<MapCell> cells;
  std::vector<double> values;
  double reach_mm = 0.0;
  for (const runs::ErrorCell& cell : run.evaluation->error_map) {
    cells.push_back({1000.0 * cell.x_m, 1000.0 * cell.y_m, cell.rms_mm});
    values.push_back(cell.rms_mm);
    reach_mm = std::max(reach_mm, std::hypot(cells.back().x_mm, cells.back().y_mm));
  }
  if (cells.empty()) return "";
  // The grid is regular: its pitch is the smallest step between two columns or rows.
  double side_mm = reach_mm;
  for (const MapCell& a : cells)
    for (const double step : {std::abs(a.x_mm - cells.front().x_mm), std::abs(a.y_mm - cells.front().y_mm)})
      if (step > 1e-6) side_mm = std::min(side_mm, step);
  std::sort(values.begin(), values.end());
  const double high = values[static_cast<std::size_t>(kMapQuantile * static_cast<double>(values.size() - 1))];
  // Without a record of the workspace the cells themselves tell how far it reaches.
  DrawnRig rig = drawn_rig(run);
  if (!run.coverage) rig.radius_mm = reach_mm;
  DishSvg dish(rig);
  dish.map(cells, side_mm, 0.0, high, "one-step error (mm RMS)", 1);
  return figure(
      dish.svg("Map of the dish: one-step position error of the learned simulator"),
      "<b>Where the simulator errs.</b> Position error of one predicted pulse by the place it starts from, "
      "on test episodes. Dark: large errors, as where the field is steep near a coil. White: no test row. "
      "The scale ends at the 97th percentile of the cells (" +
          fixed(high, 1) + " mm).");
}

}  // namespace

std::string dynamics_section(const RunData& run, const std::string& prefix) {
  const std::string command =
      "lodestone train-dynamics --set data=RUN/collect/transitions.h5 --out RUN/dynamics";
  if (!run.dynamics.present() && !run.evaluation) return missing("The learned simulator", command);
  std::string html;
  if (run.evaluation) {
    const runs::DynamicsEvaluation& evaluation = *run.evaluation;
    const double ours_mm = evaluation.one_step.position_rms_mm;
    html += "<p>On " + (evaluation.n ? grouped(static_cast<double>(*evaluation.n)) + " " : std::string()) +
            "test pulses that it never saw, the simulator misses the next position by <b>" +
            fixed(ours_mm, 3) + " mm RMS</b>";
    if (evaluation.baselines && evaluation.baselines->nearest_neighbours.position_rms_mm > 0.0) {
      const double gain = 100.0 * (1.0 - ours_mm / evaluation.baselines->nearest_neighbours.position_rms_mm);
      html += gain >= 0.0 ? ", " + fixed(gain, 0) + " % less than ten nearest neighbours"
                          : ", " + fixed(-gain, 0) + " % more than ten nearest neighbours";
    }
    html += ".</p>\n" + metrics_table(evaluation, learned_likelihood(run));
  } else {
    html += missing("The evaluation of the learned simulator", command);
  }
  html += "<div class=\"two\">";
  const std::string learning = learning_curve(run, prefix);
  html += learning.empty() ? missing("The learning curve", command) : learning;
  if (run.evaluation)
    html += open_loop(*run.evaluation, prefix) + predicted_against_actual(*run.evaluation, prefix) +
            error_map(run);
  return html + "</div>\n";
}

}  // namespace lodestone::report
