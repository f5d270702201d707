#include <algorithm>

#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"
#include "sections.h"

namespace lodestone::report {
namespace {

std::string coverage_image(const data::Coverage& coverage, const DrawnRig& rig) {
  const double radius_mm = 1000.0 * coverage.workspace_radius_m;
  const auto cells = coverage.position_cells;
  const double side_mm = 2.0 * radius_mm / static_cast<double>(cells);
  std::vector<MapCell> map;
  double most = 0.0;
  for (std::size_t i = 0; i < coverage.position_counts.size(); ++i) {
    const auto count = static_cast<double>(coverage.position_counts[i]);
    if (count < 0.0) continue;
    const auto column = static_cast<double>(i % static_cast<std::size_t>(cells));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(cells));
    map.push_back({(column + 0.5) * side_mm - radius_mm, (row + 0.5) * side_mm - radius_mm, count});
    most = std::max(most, count);
  }
  DishSvg dish(rig);
  dish.map(map, side_mm, 0.0, most, "pulses per cell", 0);
  return dish.svg("Map of the dish: recorded pulses per cell of position");
}

std::string histogram(const std::string& id, const std::string& title, const std::string& x_label,
                      const std::vector<std::int64_t>& counts, double low, double high, int decimals) {
  BarChart chart{id, title, x_label, "pulses"};
  BarSeries series;
  const double step = (high - low) / static_cast<double>(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double start = low + step * static_cast<double>(i);
    chart.categories.push_back(fixed(start, decimals) + " to " + fixed(start + step, decimals));
    series.values.emplace_back(static_cast<double>(counts[i]));
  }
  chart.series.push_back(series);
  return chart_html(chart);
}

/// How much of an operator's work it took.
std::string placed(const RunData& run) {
  if (!run.recorded || !run.recorded->placements || !run.recorded->placements_per_1000) return "";
  return " An operator placed the needle " + grouped(static_cast<double>(*run.recorded->placements)) +
         " times, <b>" + fixed(*run.recorded->placements_per_1000, 1) + "</b> per 1,000 pulses.";
}

}  // namespace

std::string collection_section(const RunData& run) {
  if (!run.coverage) return missing("The exploration", "lodestone collect --out RUN/collect");
  const data::Coverage& c = *run.coverage;
  std::string html =
      "<p>" + grouped(static_cast<double>(c.transitions)) +
      " pulses with current. Position, heading "
      "and strength of the drive make " +
      grouped(static_cast<double>(c.cells)) + " cells inside the dish; <b>" + percent(c.fraction) +
      "</b> of them were visited at least once (" + grouped(static_cast<double>(c.visited)) +
      "). Evenness, the entropy of the visits relative to an "
      "even spread, is <b>" +
      fixed(c.evenness, 3) + "</b> (1 would be even)." + placed(run) + "</p>\n<div class=\"two\">";
  html += figure(
      coverage_image(c, drawn_rig(run)),
      "<b>Where pulses were recorded.</b> Dark cells hold many, light cells few: a pale patch is a place "
      "about which the simulator has to guess. Coils are drawn schematically.");
  std::string charts;
  if (c.heading_counts.size() > 1)
    charts += histogram("heading-histogram", "Heading", "heading (degrees)", c.heading_counts, -180, 180, 0);
  if (c.drive_counts.size() > 1)
    charts += histogram("drive-histogram", "Strength of the stronger axis", "drive (fraction of the largest)",
                        c.drive_counts, 0, 1, 2);
  if (!charts.empty())
    html += figure(charts,
                   "<b>Headings and drives recorded.</b> Bars of equal height mean that no direction and no "
                   "strength was favoured.");
  return html + "</div>\n";
}

}  // namespace lodestone::report
