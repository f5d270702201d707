#include "lodestone/report/sweep_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <vector>

#include "lodestone/common/files.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"

namespace lodestone::report {
namespace {

constexpr std::size_t kMostBars = 40;

std::string score_text(const runs::SweepRow& row) {
  if (!row.mean) return "not finished";
  if (!row.interval) return fmt::format("{:.4g}", *row.mean);
  return fmt::format("{:.4g} ({:.4g} to {:.4g})", *row.mean, (*row.interval)[0], (*row.interval)[1]);
}

std::string difference_text(const runs::SweepRow& row) {
  if (!row.from_best) return "–";
  if (!row.from_best_interval) return fmt::format("{:+.3g}", *row.from_best);
  return fmt::format("{:+.3g} ({:+.3g} to {:+.3g})", *row.from_best, (*row.from_best_interval)[0],
                     (*row.from_best_interval)[1]);
}

std::int64_t finished(const runs::SweepRow& row) {
  return std::count_if(row.scores.begin(), row.scores.end(),
                       [](const auto& score) { return score.has_value(); });
}

/// The number that the only key has in a row; nothing where there are several, or it is no number.
std::optional<double> only_number(const runs::SweepRow& row) {
  if (row.point.settings.size() != 1) return std::nullopt;
  const std::string& setting = row.point.settings.front();
  const std::string value = setting.substr(setting.find('=') + 1);
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  return end == value.c_str() + value.size() && !value.empty() ? std::optional(number) : std::nullopt;
}

std::string curve(const runs::SweepResult& result, const std::vector<runs::SweepRow>& rows) {
  std::vector<std::pair<double, const runs::SweepRow*>> points;
  for (const runs::SweepRow& row : rows)
    if (const auto x = only_number(row)) points.emplace_back(*x, &row);
  std::sort(points.begin(), points.end());
  const std::string& setting = rows.front().point.settings.front();
  LineChart chart{"sweep", "Score by value", setting.substr(0, setting.find('=')), result.score};
  LineSeries mean{"mean over seeds", {}}, low{"", {}}, high{"", {}}, each{"seeds", {}, kUnseenColour};
  low.band = high.band = each.dots = true;
  for (const auto& [x, row] : points) {
    for (const auto& score : row->scores)
      if (score) each.points.emplace_back(x, *score);
    if (!row->mean) continue;
    mean.points.emplace_back(x, *row->mean);
    if (!row->interval) continue;
    low.points.emplace_back(x, (*row->interval)[0]);
    high.points.emplace_back(x, (*row->interval)[1]);
  }
  if (!low.points.empty()) chart.series = {low, high};
  chart.series.push_back(mean);
  chart.series.push_back(each);
  return figure(chart_html(chart), "Mean over seeds with its 95 % interval, and every seed.");
}

std::string bars(const runs::SweepResult& result, const std::vector<runs::SweepRow>& rows) {
  BarChart chart{"sweep", "Score", "settings", result.score};
  BarSeries means{"mean over seeds", {}};
  for (const runs::SweepRow& row : rows) {
    if (chart.categories.size() == kMostBars) break;
    chart.categories.push_back(row.point.name);
    means.values.push_back(row.mean);
  }
  chart.series.push_back(means);
  return figure(chart_html(chart), rows.size() > kMostBars
                                       ? fmt::format("The best {} of {}.", kMostBars, rows.size())
                                       : "Mean over seeds, best first.");
}

}  // namespace

std::string write_sweep_report(const runs::SweepResult& result, const std::string& folder) {
  const bool rungs =
      std::any_of(result.rows.begin(), result.rows.end(), [](const auto& row) { return row.rung > 1; });
  std::vector<std::string> headers = {"settings"};
  if (rungs) headers.emplace_back("rung");
  headers.push_back(result.score + ", mean (95 % interval)");
  headers.emplace_back("minus the best, same seeds");
  headers.emplace_back("seeds");
  std::vector<std::vector<std::string>> cells;
  std::size_t width = headers.front().size();
  for (const runs::SweepRow& row : result.rows) {
    width = std::max(width, row.point.name.size());
    cells.push_back({row.point.name});
    if (rungs) cells.back().push_back(std::to_string(row.rung));
    cells.back().push_back(score_text(row));
    cells.back().push_back(difference_text(row));
    cells.back().push_back(fmt::format("{} of {}", finished(row), row.scores.size()));
  }
  std::string text;
  const auto line = [&](const std::vector<std::string>& parts) {
    text += fmt::format("{:<{}}", parts.front(), width);
    for (std::size_t i = 1; i < parts.size(); ++i) text += "  " + parts[i];
    text += "\n";
  };
  line(headers);
  for (const auto& row : cells) line(row);

  HtmlPage page(
      "A sweep of " + result.verb,
      "Score: " + result.score + (result.lower_is_better ? ", lower is better" : ", higher is better"));
  std::vector<std::vector<std::string>> escaped = cells;
  for (auto& row : escaped)
    for (std::string& cell : row) cell = escape(cell);
  for (std::string& header : headers) header = escape(header);
  page.add_section(
      "scores", "Settings, best first",
      "<p>Every setting has the same seeds. Differences are seed by seed, from the best of the same rung. "
      "Intervals draw seeds anew; few seeds say little, and the best of many settings "
      "looks better than it is: measure it again with seeds that chose nothing.</p>" +
          table(headers, escaped, 1));
  std::vector<runs::SweepRow> last;
  for (const runs::SweepRow& row : result.rows)
    if (!result.rows.empty() && row.rung == result.rows.front().rung) last.push_back(row);
  const bool numeric = last.size() > 1 && std::all_of(last.begin(), last.end(), [](const auto& row) {
                         return only_number(row).has_value();
                       });
  if (!last.empty())
    page.add_section("picture", "Picture", numeric ? curve(result, last) : bars(result, last));
  common::make_folders(folder);
  common::write_file_atomically(folder + "/report.html", page.render());
  return text;
}

}  // namespace lodestone::report
