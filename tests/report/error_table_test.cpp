#include "lodestone/report/error_table.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using namespace lodestone::report;

TEST_CASE("a row has the interval of its trials' errors and of their success") {
  const std::vector<ErrorRow> rows = error_rows(lodestone::tests::small_run());
  REQUIRE(rows.size() == 2);  // the paper's point first
  CHECK(rows[0].published);
  CHECK_FALSE(rows[0].rms_interval_mm.has_value());
  CHECK(rows[1].rms_interval_mm->low == Approx(0.5));
  CHECK(rows[1].rms_interval_mm->high == Approx(7.125));
  CHECK(rows[1].success_interval->low == Approx(0.0945).epsilon(1e-2));
}

TEST_CASE("the heading along a path has an interval of its own") {
  RunData run;
  run.rigs = {lodestone::tests::deployment("explored", "planner")};
  DeployData& rig = run.rigs.front();
  rig.summary.tasks.by_task["circle"] = rig.summary.tasks.by_task["point"];
  rig.summary.tasks.by_task["circle"].truth->heading_rms_deg = 10.0;
  for (const double heading_rms_deg : {8.0, 12.0}) {
    rig.trials->push_back(lodestone::tests::path_trial("planner", "explored"));
    rig.trials->back().task = "circle";
    rig.trials->back().truth->heading_rms_deg = heading_rms_deg;
  }
  const std::vector<ErrorRow> rows = error_rows(run);
  REQUIRE(rows.back().task == "circle");
  CHECK(rows.back().heading_rms_deg == 10.0);
  REQUIRE(rows.back().heading_rms_interval_deg);
  CHECK(rows.back().heading_rms_interval_deg->low == Approx(8.0));
  CHECK(rows.back().heading_rms_interval_deg->high == Approx(12.0));
  CHECK_FALSE(rows.front().heading_rms_interval_deg);
}

TEST_CASE("the table for terminals has a line for each row") {
  const std::string text = error_table_text(error_rows(lodestone::tests::small_run()));
  CHECK(std::count(text.begin(), text.end(), '\n') == 5);
  CHECK(text.find("0.62") != std::string::npos);
}
