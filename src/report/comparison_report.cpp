#include "lodestone/report/comparison_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "lodestone/common/files.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"

namespace lodestone::report {
namespace {

using runs::Comparison;
using runs::ComparisonRow;
using runs::PairedFigure;

/// A figure of a row, and how it is shown.
struct Shown {
  const char* name;
  std::optional<PairedFigure> (*of)(const ComparisonRow& row);
  int decimals;
  double scale = 1.0;
};

const std::vector<Shown>& shown_figures() {
  static const std::vector<Shown> kShown = {
      {"error (mm)", [](const ComparisonRow& row) { return std::optional(row.error_mm); }, 2},
      {"failed (%)", [](const ComparisonRow& row) { return std::optional(row.failed); }, 1, 100.0},
      {"stopped early (%)", [](const ComparisonRow& row) { return std::optional(row.stopped); }, 1, 100.0},
      {"error where both succeeded (mm)", [](const ComparisonRow& row) { return row.error_of_successes_mm; },
       2},
      {"time to reach, where both did (s)", [](const ComparisonRow& row) { return row.seconds_to_reach; }, 2},
      {"path completed (%)", [](const ComparisonRow& row) { return row.completion; }, 1, 100.0}};
  return kShown;
}

std::string p_text(double p) { return p < 0.001 ? "< 0.001" : fixed(p, 3); }

std::vector<std::vector<std::string>> cells_of(const Comparison& comparison) {
  std::vector<std::vector<std::string>> rows;
  for (const ComparisonRow& row : comparison.rows)
    for (const Shown& shown : shown_figures()) {
      const std::optional<PairedFigure> figure = shown.of(row);
      if (!figure) continue;
      const auto number = [&](double value) { return fixed(shown.scale * value, shown.decimals); };
      rows.push_back({row.task + ", " + row.rig, comparison.runs[static_cast<std::size_t>(row.other)],
                      shown.name, number(figure->first), number(figure->other),
                      number(figure->difference) + " (" + number(figure->interval[0]) + " to " +
                          number(figure->interval[1]) + ")",
                      p_text(figure->signed_rank_p), std::to_string(figure->pairs),
                      std::to_string(figure->units)});
    }
  return rows;
}

std::vector<std::string> headings(const std::string& first) {
  return {"task, rig",     "run",    "figure", first, "run", "run minus " + first + " (95 % interval)",
          "signed-rank p", "trials", "units"};
}

std::string sentences_html(const Comparison& comparison) {
  std::string html = "<ul>";
  for (const ComparisonRow& row : comparison.rows) html += "<li>" + escape(row.sentence) + "</li>";
  return html + "</ul>";
}

/// Every trial as a dot: on the line both runs erred alike, below it the run erred less.
std::string picture(const Comparison& comparison, const ComparisonRow& row) {
  const std::string& first = comparison.runs.front();
  const std::string& other = comparison.runs[static_cast<std::size_t>(row.other)];
  LineChart chart{fmt::format("{}-{}-{}", row.task, row.rig, row.other), row.task + ", " + row.rig,
                  "error of " + first + " (mm)", "error of " + other + " (mm)"};
  chart.from_zero = true;
  LineSeries trials{"a trial", {}, kPolicyColour};
  trials.dots = true;
  double largest = 0.0;
  for (const auto& [x, y] : row.errors_mm) {
    trials.points.emplace_back(x, y);
    largest = std::max({largest, x, y});
  }
  LineSeries alike{"the same error", {{0.0, 0.0}, {largest, largest}}, kPaperColour};
  alike.dashed = true;
  chart.series = {alike, trials};
  return "<div class=\"panel\">" + chart_html(chart) + "</div>";
}

std::string settings_html(const Comparison& comparison) {
  if (comparison.settings.empty()) return "<p>Nothing that stands in their configurations.</p>";
  std::vector<std::string> header = {"key"};
  for (const std::string& run : comparison.runs) header.push_back(escape(run));
  header.emplace_back("changes the trials");
  std::vector<std::vector<std::string>> rows;
  for (const runs::DifferentSetting& setting : comparison.settings) {
    rows.push_back({"<code>" + escape(setting.key) + "</code>"});
    for (const std::string& value : setting.values)
      rows.back().push_back(value.empty() ? "–" : escape(value));
    rows.back().push_back(setting.of_the_trials ? "yes" : "no");
  }
  return table(header, rows, static_cast<int>(header.size()));
}

/// What is not like with like, in a line; empty where everything is.
std::string caution(const Comparison& comparison) {
  std::vector<std::string> keys;
  for (const runs::DifferentSetting& setting : comparison.settings)
    if (setting.of_the_trials) keys.push_back(setting.key);
  if (keys.empty()) return "";
  return fmt::format("Not like with like: the runs differ in {}, which may be what makes a difference.",
                     fmt::join(keys, ", "));
}

/// How many trials had no partner; empty where all had one.
std::string left_out(const Comparison& comparison) {
  std::string text;
  for (const ComparisonRow& row : comparison.rows)
    if (row.left_out > 0)
      text += fmt::format("{}{}, {}: {} trials of {} and {}",
                          text.empty() ? "Without a partner, and so left out: " : "; ", row.task, row.rig,
                          row.left_out, comparison.runs.front(),
                          comparison.runs[static_cast<std::size_t>(row.other)]);
  return text.empty() ? "" : text + ".";
}

std::string text_of(const Comparison& comparison, const std::vector<std::vector<std::string>>& cells) {
  std::string text;
  for (const ComparisonRow& row : comparison.rows) text += row.sentence + "\n";
  for (const std::string& line : {caution(comparison), left_out(comparison)})
    if (!line.empty()) text += line + "\n";
  text += "\n";
  for (const auto& row : cells)
    text += fmt::format("{:<18} {}: {}: {} -> {}, difference {}, p {}, n {}\n", row[0], row[1], row[2],
                        row[3], row[4], row[5], row[6], row[8]);
  return text;
}

}  // namespace

std::string write_comparison_report(const Comparison& comparison, const std::string& out) {
  const std::vector<std::vector<std::string>> cells = cells_of(comparison);
  HtmlPage page(fmt::format("{} runs, trial by trial", comparison.runs.size()),
                "held against " + comparison.runs.front());
  std::string said = sentences_html(comparison);
  for (const std::string& line : {caution(comparison), left_out(comparison)})
    if (!line.empty()) said += "<p class=\"missing\">" + escape(line) + "</p>";
  if (comparison.rows.size() > 1)
    said += fmt::format(
        "<p>Each of the {} rows has intervals of its own: of twenty differences that are none, one "
        "is expected to look like one.</p>",
        comparison.rows.size());
  page.add_section("said", "What can be said", said);

  std::vector<std::string> header;
  for (const std::string& heading : headings(comparison.runs.front())) header.push_back(escape(heading));
  std::vector<std::vector<std::string>> escaped = cells;
  for (auto& row : escaped)
    for (std::string& cell : row) cell = escape(cell);
  page.add_section("figures", "In numbers",
                   figure(table(header, escaped, 3),
                          "Only trials that both runs have are counted, with the same start and target. The "
                          "error is the distance "
                          "at the end, of paths the cross-track RMS. Units are what is independent: rigs "
                          "where several trials "
                          "share one, else trials; the intervals draw them anew, the p value is of "
                          "Wilcoxon's signed-rank test of "
                          "their differences."));
  std::string charts;
  for (const ComparisonRow& row : comparison.rows) charts += picture(comparison, row);
  page.add_section(
      "trials", "Trial by trial",
      figure("<div class=\"panels wide\">" + charts + "</div>",
             "A dot is a trial. Below the dashed line the run erred less than the one it is held against."));
  page.add_section("settings", "What the runs were told otherwise", settings_html(comparison));
  common::write_file_atomically(out, page.render());
  return text_of(comparison, cells);
}

}  // namespace lodestone::report
