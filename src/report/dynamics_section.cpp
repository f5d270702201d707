#include <algorithm>
#include <cmath>

#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"
#include "sections.h"

namespace lodestone::report {
namespace {

using common::Json;

// Colours of the error map end here, so that a few bad cells do not flatten the rest.
constexpr double kMapQuantile = 0.97;

std::string learning_curve(const RunData& run, const std::string& prefix) {
  LineChart chart;
  chart.id = prefix + "-loss";
  chart.title = "Loss during training";
  chart.x_label = "epoch";
  chart.y_label = "normalised loss";
  chart.log_y = true;
  const auto positive = [](Curve points) {
    points.erase(
        std::remove_if(points.begin(), points.end(), [](const auto& p) { return !(p.second > 0.0); }),
        points.end());
    return points;
  };
  const Curve train = positive(curve(run.dynamics.metrics, {"train_loss", "train/loss"}));
  const Curve validation = positive(curve(run.dynamics.metrics, {"validation_loss", "validation/loss"}));
  if (train.empty() && validation.empty()) return "";
  // A likelihood may go below zero: a logarithmic axis then cannot show it.
  chart.log_y =
      train.size() == curve(run.dynamics.metrics, {"train_loss", "train/loss"}).size() &&
      validation.size() == curve(run.dynamics.metrics, {"validation_loss", "validation/loss"}).size();
  chart.series.push_back({"training",
                          chart.log_y ? train : curve(run.dynamics.metrics, {"train_loss", "train/loss"}),
                          kPolicyColour, false});
  chart.series.push_back(
      {"validation",
       chart.log_y ? validation : curve(run.dynamics.metrics, {"validation_loss", "validation/loss"}),
       kBaselineColour, false});
  return figure(chart_html(chart),
                "<b>Learning curve.</b> Loss on the rows trained on and on episodes kept aside. A "
                "validation curve that turns upwards would mean memorising.");
}

std::string open_loop(const Json& evaluation, const std::string& prefix) {
  if (!evaluation.contains("k_step") || !evaluation["k_step"].is_object()) return "";
  LineChart chart;
  chart.id = prefix + "-open-loop";
  chart.title = "Error without correction";
  chart.x_label = "pulses predicted ahead";
  chart.y_label = "position error (mm RMS)";
  chart.from_zero = true;
  Curve points;
  for (const auto& [steps, error] : evaluation["k_step"].items())
    if (error.is_number()) points.emplace_back(std::stod(steps), error.get<double>());
  std::sort(points.begin(), points.end());
  if (points.size() < 2) return "";
  chart.series.push_back({"learned simulator", points, kPolicyColour, false});
  const auto level = [&](const char* key, const char* name, const char* colour) {
    if (const auto rms = number_at(evaluation, {"baselines", key, "position_rms_mm"}))
      chart.series.push_back(
          {name, {{points.front().first, *rms}, {points.back().first, *rms}}, colour, true});
  };
  level("no_motion", "no motion, one pulse", kPaperColour);
  level("knn10", "ten nearest neighbours, one pulse", kBaselineColour);
  return figure(
      chart_html(chart),
      "<b>Open-loop error.</b> The simulator is fed its own prediction for several pulses in a row. Dashed "
      "lines: what the two baselines miss after a single pulse.");
}

std::string metrics_table(const Json& evaluation) {
  const bool heading = number_at(evaluation, {"heading_rms_deg"}).has_value();
  std::vector<std::string> headers = {"prediction of the next state", "position (mm RMS)", "of no motion"};
  if (heading) headers.insert(headers.begin() + 2, "heading (° RMS)");
  const auto still = number_at(evaluation, {"baselines", "no_motion", "position_rms_mm"});
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const std::optional<double>& position,
                       const std::optional<double>& turn) {
    std::vector<std::string> row = {name, fixed(position, 3)};
    if (heading) row.push_back(fixed(turn, 2));
    row.push_back(position && still && *still > 0.0 ? percent(*position / *still) : "–");
    rows.push_back(row);
  };
  add("learned simulator", number_at(evaluation, {"position_rms_mm"}),
      number_at(evaluation, {"heading_rms_deg"}));
  add("ten nearest neighbours", number_at(evaluation, {"baselines", "knn10", "position_rms_mm"}),
      number_at(evaluation, {"baselines", "knn10", "heading_rms_deg"}));
  add("no motion", still, number_at(evaluation, {"baselines", "no_motion", "heading_rms_deg"}));
  std::string html = table(headers, rows, 1, {"strong"});

  std::vector<std::string> steps = {"pulses ahead"};
  std::vector<std::string> errors = {"position error (mm RMS)"};
  if (evaluation.contains("k_step") && evaluation["k_step"].is_object())
    for (const auto& [k, error] : evaluation["k_step"].items()) {
      steps.push_back(escape(k));
      errors.push_back(error.is_number() ? fixed(error.get<double>(), 2) : "–");
    }
  if (steps.size() > 1) html += table(steps, {errors}, 1);

  std::vector<std::vector<std::string>> losses;
  const auto loss = [&](const char* name, const char* key, const char* paper) {
    if (const auto value = number_at(evaluation, {key})) losses.push_back({name, fixed(value, 4), paper});
  };
  loss("training", "train_loss", "–");
  loss("validation", "validation_loss", "0.033");
  loss("test", "normalised_l2", "0.045");
  loss("test, next state instead of change", "normalised_state_l2", "–");
  if (!losses.empty()) html += table({"normalised loss", "this run", "paper"}, losses, 1);
  return html;
}

std::string error_map(const RunData& run) {
  const Json& evaluation = run.dynamics.result;
  if (!evaluation.contains("error_map") || !evaluation["error_map"].is_array()) return "";
  std::vector<MapCell> cells;
  std::vector<double> values;
  double reach_mm = 0.0;
  for (const Json& entry : evaluation["error_map"]) {
    const auto x = number_at(entry, {"x_m"});
    const auto y = number_at(entry, {"y_m"});
    const auto rms = number_at(entry, {"rms_mm"});
    if (!x || !y || !rms) continue;
    cells.push_back({1000.0 * *x, 1000.0 * *y, *rms});
    values.push_back(*rms);
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
  DishSvg dish(run.coverage ? dish_radius_mm(run) : reach_mm);
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
  if (!run.dynamics.present()) return missing("The learned simulator", command);
  const Json& evaluation = run.dynamics.result;
  std::string html;
  if (evaluation.is_object()) {
    const auto ours = number_at(evaluation, {"position_rms_mm"});
    const auto neighbours = number_at(evaluation, {"baselines", "knn10", "position_rms_mm"});
    const auto rows = number_at(evaluation, {"n"});
    html += "<p>On " + (rows ? grouped(*rows) + " " : std::string()) +
            "test pulses that it never saw, the simulator "
            "misses the next position by <b>" +
            fixed(ours, 3) + " mm RMS</b>";
    if (ours && neighbours && *neighbours > 0.0) {
      const double gain = 100.0 * (1.0 - *ours / *neighbours);
      html += gain >= 0.0 ? ", " + fixed(gain, 0) + " % less than ten nearest neighbours"
                          : ", " + fixed(-gain, 0) + " % more than ten nearest neighbours";
    }
    html += ".</p>\n" + metrics_table(evaluation);
  } else {
    html += missing("The evaluation of the learned simulator", command);
  }
  html += "<div class=\"two\">";
  const std::string learning = learning_curve(run, prefix);
  html += learning.empty() ? missing("The learning curve", command) : learning;
  if (evaluation.is_object()) html += open_loop(evaluation, prefix) + error_map(run);
  return html + "</div>\n";
}

}  // namespace lodestone::report
