#include <algorithm>
#include <cmath>

#include "lodestone/common/statistics.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "sections.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

constexpr std::size_t kWorstInTable = 8;
constexpr double kLow = 0.1;  // the band over time holds four fifths of the trials
constexpr double kHigh = 0.9;

/// The trials of one controller on one kind of rig, by what a legend calls them.
struct Group {
  std::string name;
  std::string colour;
  std::vector<Trial> trials;
};

const char* unseen_colour_of(const std::string& controller) {
  if (controller == "baseline") return kUnseenBaselineColour;
  return controller == "observer" ? kUnseenObserverColour : kUnseenColour;
}

std::vector<Group> groups_of(const RunData& run) {
  std::vector<Group> groups;
  for (const DeployData& deploy : run.rigs) {
    const std::vector<Trial> trials = read_trials(deploy);
    for (const std::string& controller : controllers_of(trials)) {
      Group group{controller + ", " + deploy.rig, colour_of(controller), {}};
      if (deploy.rig == "unseen") group.colour = unseen_colour_of(controller);
      for (const Trial& trial : trials)
        if (trial.controller == controller) group.trials.push_back(trial);
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

std::vector<const Trial*> of_task(const Group& group, const std::string& task) {
  std::vector<const Trial*> chosen;
  for (const Trial& trial : group.trials)
    if (trial.task == task) chosen.push_back(&trial);
  return chosen;
}

std::vector<std::string> tasks_of(const std::vector<Group>& groups) {
  std::vector<std::string> tasks;
  for (const char* task : runs::kTasks)
    if (std::any_of(groups.begin(), groups.end(),
                    [task](const Group& group) { return !of_task(group, task).empty(); }))
      tasks.emplace_back(task);
  return tasks;
}

bool has_times(const std::vector<const Trial*>& trials) {
  return std::all_of(trials.begin(), trials.end(), [](const Trial* trial) { return !trial->time_s.empty(); });
}

/// Median and band of the distance to the reference, by observation; trials that have ended are left out.
void add_over_time(const Group& group, const std::vector<const Trial*>& trials, bool times,
                   LineChart& chart) {
  LineSeries low{"", {}, group.colour};
  LineSeries high{"", {}, group.colour};
  LineSeries middle{group.name, {}, group.colour};
  low.band = high.band = true;  // the upper one fills the area down to the lower one
  for (std::size_t i = 0;; ++i) {
    std::vector<double> distances;
    double x = static_cast<double>(i);
    for (const Trial* trial : trials) {
      if (i >= trial->track_mm.size() || i >= trial->reference_mm.size()) continue;
      distances.push_back(trial->distance_mm(i));
      if (times) x = trial->time_s[i];
    }
    if (distances.empty()) break;
    low.points.emplace_back(x, common::percentile(distances, kLow));
    high.points.emplace_back(x, common::percentile(distances, kHigh));
    middle.points.emplace_back(x, common::median(distances));
  }
  for (LineSeries* series : {&low, &high, &middle})
    if (!series->points.empty()) chart.series.push_back(*series);
}

std::string over_time(const std::vector<Group>& groups, const std::string& task) {
  bool times = true;
  for (const Group& group : groups) times = times && has_times(of_task(group, task));
  LineChart chart{"over-time-" + task, task, times ? "time (s)" : "observation", "distance (mm)"};
  chart.from_zero = true;
  chart.small = true;
  for (const Group& group : groups) add_over_time(group, of_task(group, task), times, chart);
  return "<div class=\"panel\">" + chart_html(chart) + "</div>";
}

/// Fraction of the trials whose error is at most so large.
std::string distribution(const std::vector<Group>& groups, const std::string& task) {
  LineChart chart{"distribution-" + task, task, "error of a trial (mm)", "fraction of trials"};
  chart.from_zero = true;
  chart.y_max = 1.0;
  chart.small = true;
  for (const Group& group : groups) {
    std::vector<double> errors;
    for (const Trial* trial : of_task(group, task))
      if (std::isfinite(trial->error_mm)) errors.push_back(trial->error_mm);
    std::sort(errors.begin(), errors.end());
    if (errors.empty()) continue;
    LineSeries series{group.name, {{0.0, 0.0}}, group.colour};
    series.stepped = true;
    for (std::size_t i = 0; i < errors.size(); ++i)
      series.points.emplace_back(errors[i], static_cast<double>(i + 1) / static_cast<double>(errors.size()));
    chart.series.push_back(series);
  }
  return chart.series.empty() ? "" : "<div class=\"panel\">" + chart_html(chart) + "</div>";
}

/// What was asked for, not what it is held against, unless there is nothing else; largest error first.
std::vector<const Trial*> worst_trials(const std::vector<Group>& groups) {
  std::vector<const Trial*> trials;
  const bool only_baseline = std::all_of(groups.begin(), groups.end(), [](const Group& group) {
    return group.trials.front().controller == "baseline";
  });
  for (const Group& group : groups)
    for (const Trial& trial : group.trials)
      if (std::isfinite(trial.error_mm) && (only_baseline || trial.controller != "baseline"))
        trials.push_back(&trial);
  std::stable_sort(trials.begin(), trials.end(),
                   [](const Trial* a, const Trial* b) { return a->error_mm > b->error_mm; });
  return trials;
}

std::string worst_section(const std::vector<const Trial*>& trials, const DrawnRig& rig) {
  std::vector<std::vector<std::string>> rows;
  std::string panels;
  std::vector<const Trial*> drawn;
  for (const Trial* trial : trials) {
    std::string ended = trial->completed ? "at its time" : escape(trial->stop_reason);
    if (trial->rig_changed_s) ended += "; rig found changed after " + fixed(*trial->rig_changed_s, 0) + " s";
    if (trial->camera_moved_s) ended += "; camera slipped after " + fixed(*trial->camera_moved_s, 0) + " s";
    if (rows.size() < kWorstInTable)
      rows.push_back({escape(trial->task), escape(trial->controller), escape(trial->rig), ended,
                      std::to_string(trial->number), fixed(trial->error_mm, 2),
                      trial->success ? "yes" : "no"});
    // Of each task the worst one is drawn.
    if (std::any_of(drawn.begin(), drawn.end(),
                    [trial](const Trial* other) { return other->task == trial->task; }))
      continue;
    drawn.push_back(trial);
    panels += "<div class=\"panel\">" +
              draw_trials({trial}, rig,
                          "The worst trial of " + trial->task + ": " + fixed(trial->error_mm, 1) + " mm") +
              "<b>" + escape(trial->task) + "</b><br>" + escape(trial->rig) + ", trial " +
              std::to_string(trial->number) + ": " + fixed(trial->error_mm, 1) + " mm</div>";
  }
  const bool obstacles =
      std::any_of(drawn.begin(), drawn.end(), [](const Trial* trial) { return !trial->obstacles.empty(); });
  const bool told = drawn.size() > 1 && std::any_of(drawn.begin(), drawn.end(), [](const Trial* trial) {
                      return !trial->told_zones.empty();
                    });
  return table({"task", "controller", "rig", "ended", "trial", "error (mm)", "success"}, rows, 4) +
         figure("<div class=\"panels\">" + panels + "</div>",
                "<b>The worst trial of each task.</b> " + legend_of(drawn) +
                    (obstacles ? " Red discs: the obstacles that were drawn for that trial." : "") +
                    (told ? " Red: zones to keep out of, as they were told at first and at last." : ""));
}

std::string coil_chart(const Trial& trial, const std::string& id, const std::string& title,
                       const std::string& y_label, const std::vector<std::vector<double>>& values,
                       bool held) {
  static const char* const kNames[] = {"+x", "−x", "+y", "−y"};
  static const char* const kColours[] = {kPolicyColour, kUnseenColour, kBaselineColour, kSecondColour};
  LineChart chart{id, title, trial.time_s.empty() ? "observation" : "time (s)", y_label};
  std::size_t coils = 0;
  for (const std::vector<double>& row : values) coils = std::max(coils, row.size());
  for (std::size_t coil = 0; coil < coils; ++coil) {
    LineSeries series{coils == 4 ? kNames[coil] : "coil " + std::to_string(coil + 1), {}, kColours[coil % 4]};
    series.stepped = held;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (coil < values[i].size() && std::isfinite(values[i][coil]))
        series.points.emplace_back(trial.time_s.empty() ? static_cast<double>(i) : trial.time_s[i],
                                   values[i][coil]);
    if (!series.points.empty()) chart.series.push_back(series);
  }
  return chart.series.empty() ? "" : "<div>" + chart_html(chart) + "</div>";
}

std::string hottest(const std::vector<Group>& groups) {
  double current_A = 0.0;
  double temperature_C = -1e9;
  for (const Group& group : groups)
    for (const Trial& trial : group.trials) {
      for (const auto& row : trial.current_A)
        for (const double value : row) current_A = std::max(current_A, std::abs(value));
      for (const auto& row : trial.temperature_C)
        for (const double value : row)
          if (std::isfinite(value)) temperature_C = std::max(temperature_C, value);
    }
  return "<p>Of all trials together the largest current was " + fixed(current_A, 1) + " A" +
         (temperature_C > -1e9 ? ", the hottest coil " + fixed(temperature_C, 1) + " °C" : "") + ".</p>\n";
}

/// How strong the rig was taken to be, with the band that holds it with 95 %.
std::string gain_chart(const Trial& trial) {
  LineChart chart{"drive-gain", "", trial.time_s.empty() ? "observation" : "time (s)", "gain of the drive"};
  LineSeries low{"", {}, kPolicyColour};
  LineSeries high{"", {}, kPolicyColour};
  LineSeries mean{"identified", {}, kPolicyColour};
  low.band = high.band = true;
  for (std::size_t i = 0; i < trial.log_drive_gain.size(); ++i) {
    const auto [log_mean, log_sigma] = trial.log_drive_gain[i];
    if (!std::isfinite(log_mean)) continue;
    const double x = trial.time_s.empty() ? static_cast<double>(i) : trial.time_s[i];
    low.points.emplace_back(x, std::exp(log_mean - 1.96 * log_sigma));
    high.points.emplace_back(x, std::exp(log_mean + 1.96 * log_sigma));
    mean.points.emplace_back(x, std::exp(log_mean));
  }
  for (LineSeries* series : {&low, &high, &mean})
    if (!series->points.empty()) chart.series.push_back(*series);
  return chart.series.empty() ? "" : chart_html(chart);
}

std::string identification_figure(const Trial& shown) {
  const std::string chart = gain_chart(shown);
  if (chart.empty()) return "";
  return figure(
      chart,
      std::string("<b>What the pulses said about the rig</b> in the same trial: the factor on the drive by "
                  "which it answers more strongly than the one that its simulator was learned on, and the "
                  "band that holds it with 95 %.") +
          (shown.rig_changed_s ? " After " + fixed(*shown.rig_changed_s, 0) +
                                     " s that no longer explained what the pulses did: the rig is another."
                               : ""));
}

std::string coils_section(const std::vector<Group>& groups, const Trial& shown) {
  if (shown.current_A.size() != shown.track_mm.size())
    return missing("A record of currents and temperatures (trials.json)", "lodestone deploy");
  const std::string charts =
      coil_chart(shown, "currents", "Currents asked of the coils", "current (A)", shown.current_A, true) +
      coil_chart(shown, "temperatures", "Temperatures the coils report", "temperature (°C)",
                 shown.temperature_C, false);
  return hottest(groups) +
         figure("<div class=\"two\">" + charts + "</div>",
                "<b>Coils over one trial</b>: " + escape(shown.task) + ", " + escape(shown.controller) +
                    ", " + escape(shown.rig) + ", trial " + std::to_string(shown.number) +
                    ". Currents are drawn from one pulse to the next; between pulses the coils are off.") +
         identification_figure(shown);
}

}  // namespace

std::string trials_section(const RunData& run) {
  const std::vector<Group> groups = groups_of(run);
  if (groups.empty()) return missing("The list of trials (trials.json)", "lodestone deploy");
  std::string over;
  std::string spread;
  for (const std::string& task : tasks_of(groups)) {
    over += over_time(groups, task);
    spread += distribution(groups, task);
  }
  std::string html = figure(
      "<div class=\"panels wide\">" + over + "</div>",
      "<b>Error over time.</b> Lines: the median of the trials that still run; bands: from the 10th to "
      "the 90th percentile.");
  html += figure("<div class=\"panels wide\">" + spread + "</div>",
                 "<b>Distribution of errors.</b> The fraction of trials whose error is at most so large: of "
                 "points the distance at the end, of paths the RMS of the cross-track error. Steeper and "
                 "further left is better.");
  const std::vector<const Trial*> worst = worst_trials(groups);
  if (worst.empty()) return html;
  html += "<h3>Worst trials</h3>\n" + worst_section(worst, drawn_rig(run));
  html += "<h3>Currents and temperatures</h3>\n" + coils_section(groups, *worst.front());
  return html;
}

}  // namespace lodestone::report
