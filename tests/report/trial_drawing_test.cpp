#include "../../src/report/trial_drawing.h"

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone::report;
using lodestone::tests::holds;
using lodestone::tests::path_trial;
using lodestone::tests::point_trial;

TEST_CASE("trials are drawn in their controller's colour, with what they were after") {
  const auto trials = read_trials({point_trial("baseline", "explored")});
  const std::string svg = draw_trials(select(trials, "point", "baseline"), 42.5, "some trials");
  CHECK(holds(svg, "aria-label=\"some trials\""));
  CHECK(holds(svg, colour_of("baseline")));
  CHECK_FALSE(holds(svg, colour_of("policy")));
  CHECK(colour_of("planner") != colour_of("policy"));
  CHECK(draw_trials({}, 42.5, "none").empty());
}

TEST_CASE("the caption names what is drawn and nothing else") {
  auto trials = read_trials({point_trial("policy", "explored"), path_trial("policy", "explored")});
  CHECK(holds(legend_of({&trials[0]}), "the 3 mm"));
  const std::string by_default = draw_trials({&trials[0]}, 42.5, "trial");
  trials[0].success_radius_mm = 1.5;
  CHECK(holds(legend_of({&trials[0]}), "the 1.5 mm"));
  CHECK(draw_trials({&trials[0]}, 42.5, "trial") != by_default);
  CHECK_FALSE(holds(legend_of({&trials[0]}), "path"));
  CHECK(holds(legend_of({&trials[1]}), "path"));
  CHECK_FALSE(holds(legend_of({&trials[1]}), "3 mm"));
}

TEST_CASE("how the needle should lie is ticked along a path that has headings, and at a pose") {
  const auto ticks = [](const std::string& svg) {  // of the width that nothing else has
    int count = 0;
    for (std::size_t at = 0; (at = svg.find("stroke-width=\"0.50\"", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  auto trials = read_trials({path_trial("policy", "explored"), point_trial("policy", "explored")});
  const int none = ticks(draw_trials({&trials[0]}, 42.5, "path"));
  const int of_point = ticks(draw_trials({&trials[1]}, 42.5, "point"));
  trials[0].approach = 0;
  trials[0].reference_mm = {{0.0, 0.0}, {1.0, 0.0}, {5.0, 0.0}, {6.0, 0.0}, {10.0, 0.0}};
  trials[0].reference_heading_rad = {0.0, 0.0, 1.0, 1.0, 2.0};
  CHECK(ticks(draw_trials({&trials[0]}, 42.5, "path")) == none + 3);  // 4 mm apart at least
  CHECK(holds(legend_of({&trials[0]}), "green ticks"));
  trials[0].approach = 2;
  CHECK(ticks(draw_trials({&trials[0]}, 42.5, "path")) == none + 2);
  CHECK_FALSE(holds(legend_of({&trials[1]}), "green ticks"));
  trials[1].target_heading_rad = 0.5;
  CHECK(ticks(draw_trials({&trials[1]}, 42.5, "pose")) == of_point + 1);
  CHECK(holds(legend_of({&trials[1]}), "green ticks"));
}

TEST_CASE(
    "stitches are drawn from where the needle goes in to where it comes out, with its heading at both") {
  auto trials = read_trials({path_trial("policy", "explored")});
  trials[0].path_mm.clear();
  trials[0].reference_heading_rad = {0.0, 0.0, 0.0};
  CHECK_FALSE(holds(legend_of({&trials[0]}), "stitches"));
  trials[0].stitches = {{{-4.0, -3.0, 0.0}, {4.0, -3.0, 0.0}}};
  const std::string svg = draw_trials({&trials[0]}, 42.5, "suture");
  CHECK(holds(svg, "points=\"-4.00,3.00 "));
  CHECK(holds(svg, "4.00,3.00 \"/>"));
  CHECK(holds(svg, "points=\"-4.00,3.00 -1.00,3.00 \""));  // ticks
  CHECK(holds(svg, "points=\"4.00,3.00 7.00,3.00 \""));
  CHECK(holds(legend_of({&trials[0]}), "stitches, from a ring"));
  CHECK(holds(legend_of({&trials[0]}), "green ticks"));
}

TEST_CASE("moments at which the needle was not seen are marked, and said in the caption") {
  auto trials = read_trials({path_trial("policy", "explored")});
  trials[0].unseen = {false, true, false};
  const auto drawn = select(trials, trials[0].task, "policy");
  CHECK(holds(draw_trials(drawn, 42.5, "some"), "#d55e00"));
  CHECK(holds(legend_of(drawn), "not seen"));
  trials[0].unseen = {false, false, false};
  CHECK_FALSE(holds(draw_trials(drawn, 42.5, "some"), "#d55e00"));
  CHECK_FALSE(holds(legend_of(drawn), "not seen"));
}

TEST_CASE("the points that a needle was led over are drawn, and said in the caption") {
  auto trials = read_trials({point_trial("policy", "explored")});
  CHECK_FALSE(holds(draw_trials({&trials[0]}, 42.5, "some"), "stroke-dasharray"));
  CHECK_FALSE(holds(legend_of({&trials[0]}), "led"));
  trials[0].route_mm = {{5.0, 12.0}, {0.0, 0.0}};
  CHECK(holds(draw_trials({&trials[0]}, 42.5, "some"), "5.00,-12.00 0.00,-0.00"));
  CHECK(holds(legend_of({&trials[0]}), "led"));
}

TEST_CASE("obstacles of a trial's own are drawn where it is alone") {
  auto trials = read_trials({point_trial("policy", "explored"), point_trial("policy", "explored")});
  CHECK_FALSE(holds(draw_trials({&trials[0]}, 42.5, "some"), "keep-out"));
  trials[0].obstacles = {{{{8.5, -4.25}}, 3.0}};
  CHECK(holds(draw_trials({&trials[0]}, 42.5, "some"), "keep-out"));
  CHECK_FALSE(holds(draw_trials({&trials[0], &trials[1]}, 42.5, "some"), "keep-out"));
}

TEST_CASE("zones that were told are drawn where a trial is alone, and said in the caption") {
  auto trials = read_trials({point_trial("policy", "explored"), point_trial("policy", "explored")});
  CHECK_FALSE(holds(legend_of({&trials[0]}), "told"));
  trials[0].told_zones = {{{{8.5, -4.25}}, 3.0}};
  CHECK(holds(draw_trials({&trials[0]}, 42.5, "some"), "keep-out"));
  CHECK(holds(legend_of({&trials[0]}), "told"));
  CHECK_FALSE(holds(draw_trials({&trials[0], &trials[1]}, 42.5, "some"), "keep-out"));
  CHECK_FALSE(holds(legend_of({&trials[0], &trials[1]}), "told"));
}

TEST_CASE("a drawing becomes a file that opens by itself, an empty one none") {
  const lodestone::tests::TemporaryFolder folder;
  const auto trials = read_trials({point_trial("policy", "explored")});
  write_svg(folder / "images/a.svg", draw_trials({&trials[0]}, 42.5, "some"));
  CHECK(holds(lodestone::common::read_file(folder / "images/a.svg"), "xmlns=\"http://www.w3.org/2000/svg\""));
  write_svg(folder / "images/b.svg", "");
  CHECK_THROWS(lodestone::common::read_file(folder / "images/b.svg"));
}
