#include <catch2/catch.hpp>

#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"

using namespace lodestone::report;

TEST_CASE("text is made safe and numbers are written as readers expect") {
  CHECK(escape("<b>&\"'") == "&lt;b&gt;&amp;&quot;&#39;");
  CHECK(fixed(1.256, 2) == "1.26");
  CHECK(fixed(std::nullopt, 2) == "–");
  CHECK(plus_minus(6.3, 2.1, 1) == "6.3 ± 2.1");
  CHECK(plus_minus(6.3, std::nullopt, 1) == "6.3");
  CHECK(percent(0.87).rfind("87", 0) == 0);
}

TEST_CASE("a dish drawing holds what was put into it, with y upwards") {
  DishSvg dish(42.5);
  dish.line({{0.0, 0.0}, {10.0, 20.0}}, "#123456", 1.0, 0.5);
  dish.dot(0.0, 30.0, 1.0, "#abcdef");
  dish.map({{5.0, 5.0, 1.0}}, 5.0, 0.0, 2.0, "error (mm)", 1);
  const std::string svg = dish.svg("a <test>");
  CHECK(svg.rfind("<svg", 0) == 0);
  CHECK(svg.find("#123456") != std::string::npos);
  CHECK(svg.find("error (mm)") != std::string::npos);
  CHECK(svg.find("a &lt;test&gt;") != std::string::npos);
  for (const char* coil : {"+x", "−x", "+y", "−y"}) CHECK(svg.find(coil) != std::string::npos);
  // Upwards in the dish is a smaller y in the drawing.
  const std::size_t dot = svg.find("#abcdef");
  const std::size_t circle = svg.rfind("cy=\"", dot);
  REQUIRE(circle != std::string::npos);
  CHECK(std::stod(svg.substr(circle + 4)) < 0.0);
}

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
  CHECK(html.find("<canvas") != std::string::npos);
  CHECK(html.find("training") != std::string::npos);
  CHECK(html.size() < 40000);
}
