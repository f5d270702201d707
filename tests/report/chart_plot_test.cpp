#include "../../src/report/chart_plot.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using lodestone::common::Json;
using lodestone::tests::holds;
namespace report = lodestone::report;

namespace {

Json spec_of(const Json& categories, const Json& series) {
  return {{"title", "Bob's"}, {"x_label", "time (s)"}, {"y_label", "error, mean (mm)"},
          {"log_y", false},   {"from_zero", true},     {"categories", categories},
          {"y_max", nullptr}, {"series", series}};
}

Json line(const std::string& name, const Json& points) {
  return {{"name", name},     {"colour", "#123456"}, {"dashed", false}, {"dots", false},
          {"stepped", false}, {"band", false},       {"filled", false}, {"points", points}};
}

}  // namespace

TEST_CASE("the data of a chart are a table, a line for each point") {
  CHECK(report::chart_csv(spec_of(nullptr, {line("a", {{0.0, 1.5}, {1.0, 2.0}}), line("", {{3.0, 4.0}})})) ==
        "series,time (s),\"error, mean (mm)\"\na,0.0,1.5\na,1.0,2.0\n\"error, mean (mm)\",3.0,4.0\n");
  const Json bars = {{{"name", "x \"y\""}, {"colour", "#123456"}, {"values", {1.5, nullptr}}}};
  CHECK(report::chart_csv(spec_of({"one", "two"}, bars)) ==
        "time (s),series,\"error, mean (mm)\"\none,\"x \"\"y\"\"\",1.5\ntwo,\"x \"\"y\"\"\",\n");
}

TEST_CASE("gnuplot is told the same: labels, styles, and the area between two edges") {
  Json low = line("", {{0.0, 1.0}, {1.0, 1.1}}), high = line("", {{0.0, 2.0}, {1.0, 2.1}});
  low["band"] = high["band"] = true;
  high["filled"] = true;
  Json dots = line("dots", {{0.5, 0.5}});
  dots["dots"] = true;
  const std::string script = report::chart_gnuplot(
      spec_of(nullptr, {low, high, line("mean", {{0.0, 1.5}, {1.0, 1.6}}), dots}), "a.svg", 85.0);
  CHECK(holds(script, "set title 'Bob''s'"));
  CHECK(holds(script, "size 321,229"));
  CHECK(holds(script, "0.0 2.0 1.0\n1.0 2.1 1.1\n"));
  CHECK(holds(script, "using 1:2:3 with filledcurves"));
  CHECK(holds(script, "with points"));
  CHECK(holds(script, "title 'mean'"));
  CHECK(holds(script, "set yrange [0:*]"));
  CHECK(report::chart_gnuplot(spec_of(nullptr, Json::array()), "a.svg", 85.0).empty());
  const Json bars = {{{"name", ""}, {"colour", "#123456"}, {"values", {1.5, nullptr}}}};
  CHECK(holds(report::chart_gnuplot(spec_of({"one", "two"}, bars), "a.svg", 85.0), "1 ?\n"));
}
