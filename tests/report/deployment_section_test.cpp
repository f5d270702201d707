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

TEST_CASE("a run without a deployment says how to make one") {
  CHECK(holds(deployment_section(RunData{}), "lodestone deploy"));
}
