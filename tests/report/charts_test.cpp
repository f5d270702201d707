#include "lodestone/report/charts.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using namespace lodestone::report;
using lodestone::tests::holds;

TEST_CASE("a chart carries its data, thinned when it is long") {
  LineChart chart;
  chart.id = "loss";
  chart.title = "Loss";
  chart.x_label = "epoch";
  chart.y_label = "loss";
  LineSeries series;
  series.name = "training";
  for (int i = 0; i < 5000; ++i) series.points.emplace_back(i, 7.0);
  chart.series.push_back(series);
  const std::string html = chart_html(chart);
  CHECK(holds(html, "<canvas"));
  CHECK(holds(html, "training"));
  CHECK(html.size() < 40000);
}

TEST_CASE("dots are kept as they are, not averaged") {
  LineChart chart;
  LineSeries series;
  series.dots = true;
  for (int i = 0; i < 2000; ++i) series.points.emplace_back(i, i % 2 == 0 ? 0.0 : 10.0);
  chart.series.push_back(series);
  CHECK(holds(chart_html(chart), "[0.0,0.0],[4.0,0.0]"));
}

TEST_CASE("a chart says in words what it shows, and nothing of its bands") {
  LineChart chart;
  chart.title = "Error <over> time";
  chart.x_label = "time (s)";
  chart.y_label = "distance (mm)";
  LineSeries edge;
  edge.band = true;
  edge.points = {{0.0, 123.0}};
  chart.series = {edge, {"policy", {{0.0, 20.0}, {1.0, 30.0}, {2.0, 0.5}}}};
  CHECK(describe(chart) ==
        "Chart: Error <over> time. distance (mm) over time (s). policy: from 20 at 0 to 0.5 at 2, between "
        "0.5 and 30.");
  CHECK(holds(chart_html(chart), "aria-label=\"Chart: Error &lt;over&gt; time."));

  BarChart bars;
  bars.title = "Errors";
  bars.x_label = "task";
  bars.y_label = "error (mm)";
  bars.categories = {"centre", "point", "square"};
  bars.series = {{"policy", {1.25, std::nullopt, 2.0}}};
  CHECK(describe(bars) == "Bar chart: Errors. error (mm) over task. policy: centre 1.25, square 2.");
}

TEST_CASE("of a band the second edge fills down to the first") {
  LineChart chart;
  LineSeries edge;
  edge.band = true;
  edge.points = {{0.0, 1.0}};
  chart.series = {edge, edge, edge, edge};
  const std::string html = chart_html(chart);
  std::size_t filled = 0;
  for (std::size_t at = 0; (at = html.find("\"filled\":true", at)) != std::string::npos; ++at) ++filled;
  CHECK(filled == 2);
}
