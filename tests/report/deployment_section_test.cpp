#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using namespace lodestone::report;
using lodestone::tests::deployment;
using lodestone::tests::holds;
using lodestone::tests::small_run;

TEST_CASE("errors stand beside intervals, and only what is there is explained") {
  const std::string html = deployment_section(small_run());
  CHECK(holds(html, "0.50 to 7.12"));  // bootstrap over two trials of 0.5 and 7.125 mm
  CHECK(holds(html, "9 to 91"));       // Wilson, one of two
  CHECK(holds(html, "policy on the explored rig"));
  CHECK_FALSE(holds(html, "baseline"));
  CHECK_FALSE(holds(html, "Unseen rigs"));
}

TEST_CASE("how zones were kept out of has a table of its own, where there were any") {
  RunData run = small_run();
  CHECK_FALSE(holds(deployment_section(run), "touched"));
  lodestone::runs::ErrorStatistics& errors = *run.rigs[0].summary.tasks.by_task["point"].truth;
  errors.clearance_mm = 6.25;
  errors.least_clearance_mm = -0.75;
  errors.touching_rate = 0.25;
  errors.touching_interval = {0.05, 0.7};
  const std::string html = deployment_section(run);
  for (const char* part : {"trials that touched one", "6.25", "-0.75", "5 to 70"}) {
    CAPTURE(part);
    CHECK(holds(html, part));
  }
}

TEST_CASE(
    "obstacles that trials have of their own are drawn trial by trial, and layouts without a way counted") {
  RunData run = small_run();
  CHECK_FALSE(holds(deployment_section(run), "past obstacles"));
  lodestone::runs::TaskSummary& point = run.rigs[0].summary.tasks.by_task["point"];
  point.truth->clearance_mm = point.truth->least_clearance_mm = 2.0;
  point.truth->touching_rate = 0.0;
  CHECK_FALSE(holds(deployment_section(run), "without any way"));
  point.unreachable = 1;
  run.rigs.front().trials->front().obstacles_mm = {{10.0, -5.0, 3.0}};
  const std::string html = deployment_section(run);
  CHECK(holds(html, "without any way"));
  CHECK(holds(html, "past obstacles.</b>"));
  CHECK(holds(html, "class=\"keep-out\""));
}

TEST_CASE("where the needle can be brought is drawn with the zones and the ways, where ways were searched") {
  RunData run = small_run();
  CHECK_FALSE(holds(deployment_section(run), "can be brought"));
  lodestone::runs::ReachMap& reach = run.reach.emplace();
  reach.cell_mm = 5.0;
  reach.reachable_mm = {{2.5, 2.5}, {7.5, 2.5}};
  reach.dead_mm = {{2.5, 7.5}};
  std::string html = deployment_section(run);
  CHECK(holds(html, "0.5 cm²"));
  CHECK(holds(html, "#e3d3c4"));
  CHECK_FALSE(holds(html, "keep-out"));
  CHECK_FALSE(holds(html, "lines: the ways"));
  run.deploy.config = lodestone::common::Json::parse(
      R"({"rig": {"dish": {"radius_m": 0.0425}, "coils": {}},
          "safety": {"keep_out": [{"name": "", "corners_m": [0.01, 0.0], "radius_m": 0.004}]}})");
  run.rigs.front().trials->front().route_mm = {{10.0, 10.0}, {0.0, 0.0}};
  html = deployment_section(run);
  CHECK(holds(html, "class=\"keep-out\""));
  CHECK(holds(html, "red: zones"));
  CHECK(holds(html, "lines: the ways"));
}

TEST_CASE("every controller and rig has bars and a legend of its own") {
  lodestone::report::RunData run = small_run();
  run.rigs.push_back(deployment("unseen", "policy"));
  run.rigs.back().summary.baseline.emplace().by_task["point"] =
      run.rigs.back().summary.tasks.by_task["point"];
  const std::string html = deployment_section(run);
  for (const char* part : {"policy, explored rig", "policy, unseen rigs", "baseline, unseen rigs",
                           "Unseen rigs have", "The baseline is"}) {
    CAPTURE(part);
    CHECK(holds(html, part));
  }
}

TEST_CASE("headings along a path stand beside its other figures, where it has any") {
  RunData run = small_run();
  lodestone::runs::TaskSummary& circle = run.rigs.front().summary.tasks.by_task["circle"];
  circle = run.rigs.front().summary.tasks.by_task["point"];
  circle.truth->target_deviation_mm = 1.0;
  CHECK_FALSE(holds(deployment_section(run), "heading RMS (degrees)"));
  circle.truth->heading_rms_deg = 9.75;
  const std::string html = deployment_section(run);
  CHECK(holds(html, "heading RMS (degrees)"));
  CHECK(holds(html, "9.8"));
}

TEST_CASE("stitches have a table of their own, where there are any") {
  RunData run = small_run();
  CHECK_FALSE(holds(deployment_section(run), "titch"));
  lodestone::runs::TaskSummary& suture = run.rigs.front().summary.tasks.by_task["suture"];
  suture = run.rigs.front().summary.tasks.by_task["point"];
  suture.truth->stitches_made = 4.5;
  suture.truth->stitches_made_share = 0.9;
  suture.truth->stitch_worst_mm = 1.375;
  suture.truth->stitch_worst_deg = 6.25;
  suture.truth->heading_rms_deg = 9.75;
  const std::string html = deployment_section(run);
  for (const char* part : {"stitches made", "4.50", "90 %", "1.38", "9.8", "ends of its stitches"}) {
    CAPTURE(part);
    CHECK(holds(html, part));
  }
}

TEST_CASE("what trials took is told among the further figures") {
  RunData run = small_run();
  lodestone::runs::ErrorStatistics& errors = *run.rigs[0].summary.tasks.by_task["point"].truth;
  errors.duration_s = 20.125;
  errors.charge_As = 33.375;
  errors.heat_J = 1234.0;
  const std::string html = deployment_section(run);
  for (const char* part : {"lasted (s)", "20.1", "33.4", "1234"}) {
    CAPTURE(part);
    CHECK(holds(html, part));
  }
}

TEST_CASE("a run without a deployment says how to make one") {
  CHECK(holds(deployment_section(RunData{}), "lodestone deploy"));
}
