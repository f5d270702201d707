#include "lodestone/report/import_report.h"

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "lodestone/common/files.h"
#include "lodestone/common/named.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"

namespace lodestone::report {
namespace {

using data::CutPulse;
using data::LeftOut;
using data::LogSample;
using data::MappedColumn;
using data::MappedImport;
using data::Quantity;
using geometry::kMmPerM;

constexpr std::size_t kShownPoints = 400;  // of a chart, which averages more than 500
constexpr std::size_t kShownPulses = 12;
constexpr std::size_t kShownEpisodes = 200;
constexpr std::size_t kShownProblems = 50;

/// A number of each row, with its name, unit and decimals.
struct Reading {
  std::string name;
  int decimals;
  std::function<double(const LogSample&)> of;
};

std::vector<Reading> readings(const MappedImport& imported) {
  const double start_s = imported.log.samples.front().time_s;
  std::vector<Reading> all = {
      {"time since the first row (s)", 3, [start_s](const LogSample& s) { return s.time_s - start_s; }},
      {"x (mm)", 2, [](const LogSample& s) { return s.pose.x_m * kMmPerM; }},
      {"y (mm)", 2, [](const LogSample& s) { return s.pose.y_m * kMmPerM; }}};
  if (imported.log.heading)
    all.push_back({"heading (degrees)", 1,
                   [](const LogSample& s) { return s.pose.heading_rad * geometry::kDegPerRad; }});
  const std::string unit = " (" + imported.log.action_unit + ")";
  all.push_back({"drive x" + unit, 2, [](const LogSample& s) { return s.drive.x(); }});
  all.push_back({"drive y" + unit, 2, [](const LogSample& s) { return s.drive.y(); }});
  return all;
}

/// Which coil, or pair, the so-many-th column of currents is.
std::string coil_of(std::size_t which, std::size_t columns) {
  static const std::array<const char*, 4> kCoils = {"current of coil +x", "current of coil -x",
                                                    "current of coil +y", "current of coil -y"};
  if (columns == 4) return kCoils[which];
  return which == 0 ? "current of the pair x" : "current of the pair y";
}

std::string columns_table(const MappedImport& imported) {
  std::vector<std::vector<std::string>> rows;
  const std::size_t currents = imported.log.of(Quantity::kCurrents).size();
  std::size_t current = 0;
  for (const MappedColumn& column : imported.log.columns)
    rows.push_back({column.quantity == Quantity::kCurrents ? coil_of(current++, currents)
                                                           : common::name_of(column.quantity),
                    escape(common::shown(column.header)), std::to_string(column.index + 1), column.unit.name,
                    column.unit_given ? "--units" : "the header"});
  std::string html = figure(table({"meaning", "column", "number", "unit", "said by"}, rows, 5),
                            "<b>What each column means.</b> Lengths become metres, angles radians.");
  std::string ignored;
  for (const std::string& header : imported.log.ignored)
    ignored += (ignored.empty() ? "" : ", ") + escape(common::shown(header));
  if (!ignored.empty()) html += "<p>Columns that mean nothing here: " + ignored + ".</p>";
  const common::CsvFormat& format = imported.log.format;
  const std::string separator = format.separator == '\t' ? "a tab"
                                : format.separator == ' '
                                    ? "blanks"
                                    : std::string("<code>") + format.separator + "</code>";
  return html + "<p>Cells are separated by " + separator + ", numbers have a decimal " +
         (format.decimal == ',' ? "comma" : "point") + ".</p>";
}

std::string ranges_table(const MappedImport& imported) {
  std::vector<std::vector<std::string>> rows;
  for (const Reading& reading : readings(imported)) {
    std::vector<double> values;
    for (const LogSample& sample : imported.log.samples) values.push_back(reading.of(sample));
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const std::string least = fixed(*low, reading.decimals);
    const std::string most = fixed(*high, reading.decimals);
    rows.push_back({reading.name, least, fixed(common::median(std::move(values)), reading.decimals), most});
  }
  return figure(table({"as understood", "least", "median", "most"}, rows, 1),
                "<b>How large things are.</b> A wrong unit or centre shows here.");
}

std::string first_rows(const MappedImport& imported) {
  std::vector<std::string> headers;
  for (const MappedColumn& column : imported.log.columns)
    headers.push_back(escape(common::shown(column.header)));
  std::vector<std::vector<std::string>> raw;
  for (const std::vector<std::string>& cells : imported.log.first_rows) {
    raw.emplace_back();
    for (const std::string& cell : cells) raw.back().push_back(escape(common::shown(cell)));
  }
  std::vector<std::string> names;
  for (const Reading& reading : readings(imported)) names.push_back(reading.name);
  std::vector<std::vector<std::string>> understood;
  for (std::size_t i = 0; i < std::min(raw.size(), imported.log.samples.size()); ++i) {
    understood.emplace_back();
    for (const Reading& reading : readings(imported))
      understood.back().push_back(fixed(reading.of(imported.log.samples[i]), reading.decimals));
  }
  return figure(table(headers, raw, 0), "<b>First rows of the file.</b>") +
         figure(table(names, understood, 0), "<b>First rows as understood</b>, in the dish's frame.");
}

std::string trajectories(const MappedImport& imported) {
  const data::Dataset& dataset = imported.result.dataset;
  const auto s = static_cast<std::size_t>(data::state_size(dataset.info.layout));
  DishSvg dish(dataset.info.workspace_radius_m * kMmPerM);
  const std::size_t stride = 1 + dataset.episodes.size() / kShownEpisodes;
  for (std::size_t e = 0; e < dataset.episodes.size(); e += stride) {
    const std::vector<double>& seen = dataset.episodes[e].observations;
    Points points;
    for (std::size_t i = 0; i < seen.size(); i += s)
      points.emplace_back(kMmPerM * seen[i], kMmPerM * seen[i + 1]);
    dish.line(points, kPolicyColour, 0.35, 0.5);
    dish.dot(points.front().first, points.front().second, 0.6, kBaselineColour);
  }
  return figure(dish.svg("The dish with the recorded trajectories"),
                "<b>Where it went</b>, from pulse to pulse; red dots are the beginnings of " +
                    std::string(stride > 1 ? "some of the " : "the ") +
                    grouped(static_cast<double>(dataset.episodes.size())) + " episodes.");
}

/// The first pulses: currents as logged, and as they were cut.
std::string cutting(const MappedImport& imported) {
  const std::vector<LogSample>& samples = imported.log.samples;
  const std::vector<CutPulse>& pulses = imported.cut.pulses;
  const double start_s = samples.front().time_s;
  const double until_s = pulses[std::min(kShownPulses, pulses.size()) - 1].to_s;
  std::string charts;
  for (const int axis : {0, 1}) {
    const std::string name = axis == 0 ? "x" : "y";
    LineChart chart{"cut-" + name, "Drive " + name, "time since the first row (s)",
                    "drive " + name + " (" + imported.log.action_unit + ")"};
    LineSeries logged{"as logged", {}, kPaperColour};
    LineSeries cut{"as cut into pulses", {}, kPolicyColour};
    logged.stepped = true;
    for (const LogSample& sample : samples) {
      if (sample.time_s > until_s || logged.points.size() == kShownPoints) break;
      logged.points.emplace_back(sample.time_s - start_s, sample.drive[axis]);
    }
    for (std::size_t i = 0; i < std::min(kShownPulses, pulses.size()); ++i) {
      cut.points.emplace_back(pulses[i].from_s - start_s, pulses[i].drive[axis]);
      cut.points.emplace_back(pulses[i].to_s - start_s, pulses[i].drive[axis]);
    }
    chart.series = {logged, cut};
    charts += chart_html(chart);
  }
  return figure(
      charts, "<b>The first " + std::to_string(std::min(kShownPulses, pulses.size())) +
                  " steps.</b> A step at zero is a rest; where time was left out the line goes straight on.");
}

std::string summary(const MappedImport& imported) {
  const data::CutLog& cut = imported.cut;
  const auto driven = static_cast<double>(std::count_if(
      cut.pulses.begin(), cut.pulses.end(), [](const CutPulse& pulse) { return !pulse.drive.isZero(0.0); }));
  std::string html = "<p>" + grouped(static_cast<double>(imported.result.rows)) + " rows, " +
                     fixed(cut.spacing_s, 4) + " s apart (median), became <b>" + grouped(driven) +
                     " pulses</b> of " + fixed(cut.period_s, 4) + " s and " +
                     grouped(static_cast<double>(cut.pulses.size()) - driven) + " rests, in " +
                     grouped(static_cast<double>(imported.result.dataset.episodes.size())) +
                     (imported.result.dataset.episodes.size() == 1 ? " episode." : " episodes.");
  if (cut.interpolated > 0)
    html += " " + grouped(static_cast<double>(cut.interpolated)) + " poses were taken from between two rows.";
  if (imported.log.reversed > 0)
    html += " In " + grouped(static_cast<double>(imported.log.reversed)) +
            " rows a current below zero drives the opposite coil (map.negative_current).";
  if (imported.log.netted > 0)
    html += " In " + grouped(static_cast<double>(imported.log.netted)) +
            " rows opposite coils were on together, and their difference counts (map.opposite_currents).";
  const data::DirectionMatch& match = imported.directions;
  html += "</p><p>Motion goes with the drives to " + fixed(match.as_is, 2) +
          " (1: always towards the coils that are on)";
  if (!match.best_way.empty() && match.best > match.as_is)
    html += "; it would go with them to " + fixed(match.best, 2) + " if " + escape(match.best_way);
  return html + ".</p>";
}

std::string left_out(const MappedImport& imported) {
  struct Sum {
    double count = 0.0, seconds = 0.0;
    std::int64_t line = 0;
  };
  std::array<Sum, 3> sums;
  for (const data::LeftOutSpan& span : imported.cut.left_out) {
    Sum& sum = sums[static_cast<std::size_t>(span.why)];
    if (sum.count == 0.0) sum.line = span.line;
    sum.count += 1.0;
    sum.seconds += span.to_s - span.from_s;
  }
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i].count > 0.0)
      rows.push_back({common::name_of(static_cast<LeftOut>(i)), grouped(sums[i].count),
                      fixed(sums[i].seconds, 2), "line " + std::to_string(sums[i].line)});
  std::string html = "<p>Steps last " + fixed(imported.cut.period_s, 4) +
                     " s (control_period_s), give or take map.tolerance; rows more than " +
                     fixed(imported.cut.longest_gap_s, 4) +
                     " s apart (map.longest_gap_s) are not connected.</p>";
  if (!rows.empty())
    html +=
        figure(table({"why", "times", "together (s)", "first"}, rows, 1), "<b>Time that became no step.</b>");
  std::string list;
  std::size_t shown = 0;
  for (const std::vector<std::string>* texts : {&imported.result.problems, &imported.result.impossible})
    for (const std::string& text : *texts)
      if (shown++ < kShownProblems) list += "<li>" + escape(common::shown(text)) + "</li>";
  if (imported.result.skipped > 0)
    html +=
        "<p>" + grouped(static_cast<double>(imported.result.skipped)) + " malformed rows were skipped.</p>";
  if (!list.empty()) html += "<ul>" + list + "</ul>";
  return html;
}

}  // namespace

void write_import_report(const MappedImport& imported, const std::string& source, const std::string& out) {
  HtmlPage page("How " + common::shown(source.substr(source.find_last_of('/') + 1)) + " was understood",
                common::shown(source));
  page.add_section("summary", "In short", summary(imported));
  page.add_section("columns", "Columns and units", columns_table(imported) + ranges_table(imported));
  page.add_section("rows", "First rows", first_rows(imported));
  page.add_section("trajectories", "Trajectories", trajectories(imported));
  page.add_section("pulses", "Currents, and how they were cut", cutting(imported));
  page.add_section("left-out", "What was left out, and why", left_out(imported));
  common::write_file_atomically(out, page.render());
}

}  // namespace lodestone::report
