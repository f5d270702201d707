#include <algorithm>
#include <functional>

#include "lodestone/report/charts.h"
#include "lodestone/report/error_table.h"
#include "lodestone/report/html.h"
#include "lodestone/runs/curves.h"
#include "sections.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

constexpr std::size_t kDrawnLayouts = 6;

/// Classes of the table's rows: the paper's, ours, and where a task begins.
std::string class_of(const ErrorRow& row, bool first_of_task) {
  const std::string kind = row.published ? "published" : row.controller == "baseline" ? "" : "ours";
  return kind + (first_of_task ? " first" : "");
}

std::string interval(const std::optional<common::Interval>& range, double scale, int decimals) {
  return range ? fixed(scale * range->low, decimals) + " to " + fixed(scale * range->high, decimals) : "–";
}

/// `columns`: headers of the figures, and the cells of one row.
std::string rows_table(const std::vector<ErrorRow>& rows, const std::vector<std::string>& columns,
                       const std::function<std::vector<std::string>(const ErrorRow&)>& cells_of) {
  std::vector<std::string> headers = {"task", "controller", "rig"};
  headers.insert(headers.end(), columns.begin(), columns.end());
  std::vector<std::vector<std::string>> cells;
  std::vector<std::string> classes;
  std::string task;
  for (const ErrorRow& row : rows) {
    const bool first = row.task != task && !task.empty();
    task = row.task;
    const std::string name = row.task == "square" && row.published ? "square (“box”)" : row.task;
    cells.push_back({escape(name), escape(row.controller), escape(row.rig)});
    for (std::string& cell : cells_of(row)) cells.back().push_back(std::move(cell));
    classes.push_back(class_of(row, first));
  }
  return table(headers, cells, 3, classes);
}

/// By the true pose, or as sensed where nobody knows that.
std::string error_of(const ErrorRow& row) {
  return row.mean_mm ? plus_minus(row.mean_mm, row.std_mm, row.published ? 1 : 2)
                     : plus_minus(row.sensed_mean_mm, row.sensed_std_mm, 2) + " as sensed";
}

/// How well paths were followed; empty where there are none.
std::string path_table(const std::vector<ErrorRow>& rows) {
  std::vector<ErrorRow> paths;
  for (const ErrorRow& row : rows)
    if (row.target_deviation_mm) paths.push_back(row);
  if (paths.empty()) return "";
  const bool headed = std::any_of(paths.begin(), paths.end(),
                                  [](const ErrorRow& row) { return row.heading_rms_deg.has_value(); });
  std::vector<std::string> columns = {"deviation from the targets (mm)", "RMS to moving reference (mm)",
                                      "completion", "corners reached", "Fréchet distance (mm)"};
  if (headed) columns.emplace_back("heading RMS (degrees)");
  if (headed) columns.emplace_back("95 % interval (degrees)");
  return rows_table(paths, columns, [headed](const ErrorRow& row) {
    std::vector<std::string> cells = {
        row.published ? plus_minus(row.target_deviation_mm, row.target_deviation_std_mm, 1)
                      : fixed(row.target_deviation_mm, 2),
        fixed(row.time_rms_mm, 2), percent(row.completion), percent(row.corners_reached),
        fixed(row.frechet_mm, 2)};
    if (headed) cells.push_back(fixed(row.heading_rms_deg, 1));
    if (headed) cells.push_back(interval(row.heading_rms_interval_deg, 1.0, 1));
    return cells;
  });
}

/// How well stitches were made; empty where there are none.
std::string suture_table(const std::vector<ErrorRow>& rows) {
  std::vector<ErrorRow> sutures;
  for (const ErrorRow& row : rows)
    if (row.stitches_made) sutures.push_back(row);
  if (sutures.empty()) return "";
  return rows_table(sutures,
                    {"stitches made", "share of all", "worst end (mm)", "worst heading at an end (degrees)",
                     "heading RMS (degrees)", "95 % interval (degrees)"},
                    [](const ErrorRow& row) -> std::vector<std::string> {
                      return {fixed(row.stitches_made, 2),   percent(row.stitches_made_share),
                              fixed(row.stitch_worst_mm, 2), fixed(row.stitch_worst_deg, 1),
                              fixed(row.heading_rms_deg, 1), interval(row.heading_rms_interval_deg, 1.0, 1)};
                    });
}

/// How well zones were kept out of; empty where there are none.
std::string keep_out_table(const std::vector<ErrorRow>& rows) {
  std::vector<ErrorRow> kept_out;
  for (const ErrorRow& row : rows)
    if (row.touching_rate) kept_out.push_back(row);
  if (kept_out.empty()) return "";
  const bool drawn = std::any_of(kept_out.begin(), kept_out.end(),
                                 [](const ErrorRow& row) { return row.unreachable.has_value(); });
  std::vector<std::string> columns = {"clearance from the nearest zone (mm)", "least of all trials (mm)",
                                      "trials that touched one", "95 % interval (%)"};
  if (drawn) columns.emplace_back("without any way");
  return rows_table(kept_out, columns, [drawn](const ErrorRow& row) {
    std::vector<std::string> cells = {fixed(row.clearance_mm, 2), fixed(row.least_clearance_mm, 2),
                                      percent(row.touching_rate), interval(row.touching_interval, 100.0, 0)};
    if (drawn) cells.push_back(fixed(row.unreachable, 0));
    return cells;
  });
}

std::string error_tables(const std::vector<ErrorRow>& rows) {
  std::string html = rows_table(rows,
                                {"error, mean ± std (mm)", "RMS (mm)", "95 % interval (mm)", "success",
                                 "95 % interval (%)", "stopped", "trials"},
                                [](const ErrorRow& row) -> std::vector<std::string> {
                                  return {error_of(row),
                                          fixed(row.rms_mm, 2),
                                          interval(row.rms_interval_mm, 1.0, 2),
                                          percent(row.success_rate),
                                          interval(row.success_interval, 100.0, 0),
                                          fixed(row.stopped, 0),
                                          fixed(row.trials, 0)};
                                });
  html += path_table(rows) + suture_table(rows) + keep_out_table(rows);
  std::vector<ErrorRow> ours;
  for (const ErrorRow& row : rows)
    if (!row.published) ours.push_back(row);
  html +=
      "<details><summary>Further figures: medians, as sensed, holding, time to reach, what it "
      "took</summary>" +
      rows_table(ours,
                 {"median (mm)", "as sensed, mean ± std (mm)", "holding (mm)", "to reach (s)", "lasted (s)",
                  "charge (A s)", "heat in the coils (J)"},
                 [](const ErrorRow& row) -> std::vector<std::string> {
                   return {fixed(row.median_mm, 2),  plus_minus(row.sensed_mean_mm, row.sensed_std_mm, 2),
                           fixed(row.hold_mm, 2),    fixed(row.seconds_to_reach, 1),
                           fixed(row.duration_s, 1), fixed(row.charge_As, 1),
                           fixed(row.heat_J, 0)};
                 }) +
      "</details>\n";
  return html;
}

std::string rig_words(const std::string& rig) { return rig == "unseen" ? "unseen rigs" : rig + " rig"; }

const char* bar_colour(const ErrorRow& row) {
  if (row.published) return kPaperColour;
  if (row.controller == "baseline") return row.rig == "unseen" ? kUnseenBaselineColour : kBaselineColour;
  if (row.controller == "observer") return row.rig == "unseen" ? kUnseenObserverColour : kObserverColour;
  return row.rig == "unseen" ? kUnseenColour : kPolicyColour;
}

/// One series for each controller and rig that is in the rows; of the paper's rows those of its own method.
std::string bar_chart(const std::vector<ErrorRow>& rows) {
  BarChart chart{"deploy-errors", "Mean error by task", "task", "mean error (mm)"};
  for (const ErrorRow& row : rows)
    if (std::find(chart.categories.begin(), chart.categories.end(), row.task) == chart.categories.end())
      chart.categories.push_back(row.task);
  for (const ErrorRow& row : rows) {
    if (row.published && row.controller != "trained in an MBS") continue;
    const std::string name =
        row.published ? "paper's policy, on its real rig" : row.controller + ", " + rig_words(row.rig);
    auto series = std::find_if(chart.series.begin(), chart.series.end(),
                               [&name](const BarSeries& each) { return each.name == name; });
    if (series == chart.series.end()) {
      chart.series.push_back(
          {name, std::vector<std::optional<double>>(chart.categories.size()), bar_colour(row)});
      series = chart.series.end() - 1;
    }
    const auto place = std::find(chart.categories.begin(), chart.categories.end(), row.task);
    series->values[static_cast<std::size_t>(place - chart.categories.begin())] = row.mean_mm;
  }
  return chart_html(chart);
}

std::string bar_caption(const std::vector<ErrorRow>& rows) {
  const bool paper = std::any_of(rows.begin(), rows.end(), [](const ErrorRow& row) {
    return row.published && row.controller == "trained in an MBS";
  });
  return std::string("<b>Mean error by task.</b> Lower is better.") +
         (paper ? " Grey: the paper's policy trained in its own learned simulator, on its real rig." : "");
}

/// One small dish: some trials of a task by one controller.
std::string panel(const std::vector<const Trial*>& trials, const std::string& task,
                  const std::string& controller, const DrawnRig& rig, const std::vector<ErrorRow>& rows) {
  std::string html = "<div class=\"panel\">" +
                     draw_trials(trials, rig, "Trajectories: " + task + ", " + controller) + "<b>" +
                     escape(task) + "</b>";
  for (const ErrorRow& row : rows)
    if (row.task == task && row.controller == controller && row.rig == trials.front()->rig)
      html += "<br>" + (row.mean_mm ? plus_minus(row.mean_mm, row.std_mm, 1) + " mm, " +
                                          percent(row.success_rate) + " success"
                                    : plus_minus(row.sensed_mean_mm, row.sensed_std_mm, 1) + " mm as sensed");
  return html + "</div>";
}

std::string panels(const std::vector<Trial>& trials, const std::string& controller,
                   const std::vector<ErrorRow>& rows, const DrawnRig& rig) {
  std::string html;
  std::vector<const Trial*> drawn;
  for (const char* task : runs::kTasks) {
    const std::vector<const Trial*> chosen = select(trials, task, controller);
    if (chosen.empty()) continue;
    html += panel(chosen, task, controller, rig, rows);
    drawn.insert(drawn.end(), chosen.begin(), chosen.end());
  }
  if (drawn.empty()) return "";
  return figure(
      "<div class=\"panels\">" + html + "</div>",
      "<b>" + escape(controller) + " on the " + escape(rig_words(drawn.front()->rig)) + ".</b> " +
          (drawn.front()->track_is_true ? "True trajectories" : "Trajectories as the camera saw them") +
          " of up to " + std::to_string(kDrawnTrials) +
          " trials of each task, seen from above, with the coils drawn schematically. " + legend_of(drawn) +
          (rig.keep_out.empty() ? "" : " Red areas: zones that the needle must keep out of."));
}

/// The first trials of a controller that had obstacles of their own, each in its dish; empty where none had.
std::string layouts(const std::vector<Trial>& trials, const std::string& controller, const DrawnRig& rig) {
  std::string html;
  std::size_t shown = 0;
  for (const Trial& trial : trials) {
    if (trial.controller != controller || trial.obstacles.empty() || shown >= kDrawnLayouts) continue;
    ++shown;
    html +=
        "<div class=\"panel\">" +
        draw_trials({&trial}, rig, trial.task + " past obstacles, trial " + std::to_string(trial.number)) +
        "<b>" + escape(trial.task) + "</b>, trial " + std::to_string(trial.number) + "<br>" +
        fixed(trial.error_mm, 1) + " mm, " + (trial.success ? "reached" : "not reached") + "</div>";
  }
  if (html.empty()) return "";
  return figure("<div class=\"panels\">" + html + "</div>",
                "<b>" + escape(controller) +
                    " past obstacles.</b> Red discs: solid obstacles that were drawn "
                    "for that trial alone.");
}

std::string trajectories(const RunData& run, const std::vector<ErrorRow>& rows) {
  std::string html;
  for (const DeployData& deploy : run.rigs) {
    const std::vector<Trial> trials = read_trials(deploy);
    if (trials.empty()) {
      html += missing("The list of trials on the " + deploy.rig + " rig (trials.json)", "lodestone deploy");
      continue;
    }
    std::string shown;
    for (const std::string& controller : controllers_of(trials))
      shown += panels(trials, controller, rows, drawn_rig(run)) + layouts(trials, controller, drawn_rig(run));
    html += &deploy == &run.rigs.front()
                ? shown
                : "<details><summary>Trajectories on the " + escape(rig_words(deploy.rig)) + "</summary>" +
                      shown + "</details>\n";
  }
  return html;
}

Points points_of_map(const std::vector<runs::PointMm>& cells) {
  Points points;
  for (const runs::PointMm& cell : cells) points.emplace_back(cell[0], cell[1]);
  return points;
}

/// Where the needle can be brought, with zones and the ways that it was led; empty where none were searched.
std::string reach_figure(const RunData& run) {
  if (!run.reach) return "";
  const runs::ReachMap& reach = *run.reach;
  const DrawnRig rig = drawn_rig(run);
  DishSvg dish(rig);
  dish.squares(points_of_map(reach.reachable_mm), reach.cell_mm, "#d5ead9");
  dish.squares(points_of_map(reach.dead_mm), reach.cell_mm, "#e3d3c4");
  std::size_t ways = 0;
  if (!run.rigs.empty()) {
    for (const Trial& trial : read_trials(run.rigs.front())) {
      if (trial.route_mm.empty() || trial.track_mm.empty() || ways >= kDrawnTrials) continue;
      Points way = {trial.track_mm.front()};
      way.insert(way.end(), trial.route_mm.begin(), trial.route_mm.end());
      dish.line(way, "#34495e", 0.5, 0.7);
      dish.dot(way.back().first, way.back().second, 0.9, "#34495e");
      ++ways;
    }
  }
  const double area_cm2 =
      static_cast<double>(reach.reachable_mm.size()) * reach.cell_mm * reach.cell_mm / 100.0;
  return figure(
      dish.svg("Map of the dish: where the needle can be brought"),
      "<b>Where the needle can be brought</b>, " + fixed(area_cm2, 1) +
          " cm². Green: cells that pulses brought it to and took it out of again; brown: others that "
          "they came to: dead zones, and what was seldom visited" +
          (rig.keep_out.empty() ? "" : "; red: zones that it must keep out of") +
          (ways == 0
               ? "."
               : "; lines: the ways that it was led, of up to " + std::to_string(kDrawnTrials) + " trials."));
}

/// What the figures below are, as far as it is true of these rows.
std::string introduction(const std::vector<ErrorRow>& rows) {
  const auto any = [&rows](auto what) { return std::any_of(rows.begin(), rows.end(), what); };
  const bool real = any([](const ErrorRow& row) { return row.rig == "real"; });
  std::string text = real
                         ? "The rig was driven by camera, and is scored by what the camera saw: nobody knows "
                           "the true pose. "
                         : "The virtual rig was driven. Errors are against the true pose unless "
                           "they say <i>as sensed</i>. ";
  if (any([](const ErrorRow& row) { return row.rig == "unseen"; }))
    text += "Unseen rigs have a friction map and a calibration error that are new to the controller. ";
  if (any([](const ErrorRow& row) { return row.controller == "baseline"; }))
    text += "The baseline is a proportional pull through the inverse field of the plain simulator. ";
  if (any([](const ErrorRow& row) { return row.controller == "observer"; }))
    text +=
        "The observer is sliding mode with a disturbance observer: it knows the rig's description and its "
        "own "
        "pulses. ";
  if (any([](const ErrorRow& row) { return row.stitches_made.has_value(); }))
    text +=
        "Of a suture the error is the RMS distance of the needle from the ends of its stitches, each where "
        "it was "
        "nearest; a trial succeeds where every stitch was made. ";
  text +=
      "For points the error is the distance at the end of a trial, for paths the cross-track RMS of one. A "
      "path succeeds where 95 % of its points were reached in order and in time, every corner was, and the "
      "error is within the radius; a trial that was stopped is scored with the needle where it lay. "
      "Intervals "
      "are 95 %: a bootstrap over the trials, and Wilson's for success.";
  if (any([](const ErrorRow& row) { return row.published; }))
    text += " The paper's figures (Table II, italic) come from its real rig.";
  return "<p>" + text + "</p>\n";
}

}  // namespace

std::string deployment_section(const RunData& run) {
  if (run.rigs.empty())
    return missing("The deployment",
                   "lodestone deploy --policy RUN/policy/checkpoint --task all --on both --out RUN/deploy");
  const std::vector<ErrorRow> rows = error_rows(run);
  std::string html = introduction(rows) + error_tables(rows);
  html += figure(bar_chart(rows), bar_caption(rows));
  return html + reach_figure(run) + trajectories(run, rows);
}

std::string recorded_section(const RunData& run, const RunData& recorded) {
  std::string html =
      "<p>The same two steps on recordings of a real rig: a magnetic sphere on a four-coil device, one coil "
      "at a time. "
      "Its state is a position without a heading, so errors are comparable in kind, not in size.</p>\n";
  const auto row = [](const char* name, const RunData& r) -> std::vector<std::string> {
    const Curve success = curve(r.policy.metrics, runs::curves::kSuccess);
    const Curve error = curve(r.policy.metrics, runs::curves::kEpisodeEndError);
    std::vector<std::string> cells = {name, "–", "–", "–", "–"};
    if (r.evaluation) {
      if (r.evaluation->n) cells[1] = grouped(static_cast<double>(*r.evaluation->n));
      cells[2] = fixed(r.evaluation->one_step.position_rms_mm, 3);
      if (r.evaluation->baselines) {
        cells[3] = fixed(r.evaluation->baselines->nearest_neighbours.position_rms_mm, 3);
        cells[4] = fixed(r.evaluation->baselines->no_motion.position_rms_mm, 3);
      }
    }
    if (r.trained && r.trained->fresh_evaluation) {
      cells.push_back(percent(r.trained->fresh_evaluation->success_rate));
      cells.push_back(fixed(r.trained->fresh_evaluation->episode_end_error_mm, 2));
    } else {
      cells.push_back(success.empty() ? "–" : percent(success.back().second));
      cells.push_back(error.empty() ? "–" : fixed(error.back().second, 2));
    }
    return cells;
  };
  html += table(
      {"trained on", "test pulses", "simulator (mm RMS)", "ten neighbours (mm RMS)", "no motion (mm RMS)",
       "policy success in its simulator", "distance there at the end of an episode (mm)"},
      {row("virtual rig, needle", run), row("real recordings, sphere", recorded)}, 1);
  html +=
      "<h3>Simulator learned from the recordings</h3>\n" + dynamics_section(recorded, "recorded-dynamics");
  html += "<h3>Policy trained in it</h3>\n" +
          policy_section(recorded.policy, recorded.trained, "recorded-policy");
  return html;
}

}  // namespace lodestone::report
