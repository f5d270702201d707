#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using lodestone::tests::holds;

TEST_CASE("what was recorded is counted and mapped, or missing") {
  lodestone::report::RunData run;
  CHECK(holds(lodestone::report::collection_section(run), "lodestone collect"));
  lodestone::data::Coverage& coverage = run.coverage.emplace();
  coverage.transitions = 1234;
  coverage.fraction = 0.75;
  coverage.workspace_radius_m = 0.02;
  coverage.position_cells = 2;
  coverage.position_counts = {1, -1, 3, 4};
  coverage.heading_counts = {5, 6};
  const std::string html = lodestone::report::collection_section(run);
  CHECK(holds(html, "1\u202f234"));
  CHECK(holds(html, "75 %"));
  CHECK(holds(html, "heading-histogram"));
  CHECK_FALSE(holds(html, "drive-histogram"));
  CHECK_FALSE(holds(html, "An operator"));
  run.recorded.emplace().placements = 12;
  run.recorded->placements_per_1000 = 3.25;
  CHECK(holds(lodestone::report::collection_section(run), "12 times, <b>3.2"));
}
