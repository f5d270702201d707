#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using lodestone::tests::holds;

TEST_CASE("predictions are held against what happened, and baselines are named where there are any") {
  lodestone::report::RunData run;
  CHECK(holds(lodestone::report::dynamics_section(run, "d"), "lodestone train-dynamics"));
  lodestone::runs::DynamicsEvaluation& evaluation = run.evaluation.emplace();
  evaluation.one_step.position_rms_mm = 2.5;
  evaluation.open_loop.k_step_mm = {{1, 2.5}, {2, 4.0}};
  evaluation.predictions.emplace().push_back({{3.0, 4.0}, {2.5, 4.5}});
  std::string html = lodestone::report::dynamics_section(run, "d");
  CHECK(holds(html, "2.500 mm RMS"));
  CHECK(holds(html, "id=\"d-predicted\""));
  CHECK(holds(html, "[3.0,2.5]"));
  CHECK_FALSE(holds(html, "Dashed lines: what the two baselines"));
  evaluation.baselines = lodestone::runs::DynamicsBaselines{{13.5, {}}, {5.0, {}}};
  html = lodestone::report::dynamics_section(run, "d");
  CHECK(holds(html, "50 % less than ten nearest neighbours"));
  CHECK(holds(html, "Dashed lines: what the two baselines"));
  CHECK_FALSE(holds(html, "of ten nearest neighbours"));
  CHECK_FALSE(holds(html, "the region that should hold"));
}

TEST_CASE("what baselines miss open loop and how often regions hold is told where it was measured") {
  lodestone::report::RunData run;
  lodestone::runs::DynamicsEvaluation& evaluation = run.evaluation.emplace();
  evaluation.open_loop.k_step_mm = {{1, 2.5}, {2, 4.0}};
  evaluation.open_loop.k_step_heading_deg = {{1, 11.5}, {2, 12.25}};
  lodestone::runs::DynamicsBaselines& baselines = evaluation.baselines.emplace();
  lodestone::runs::OpenLoopError& neighbours = baselines.nearest_neighbours_open_loop.emplace();
  neighbours.k_step_mm = {{1, 5.0}, {2, 8.75}};
  neighbours.k_step_heading_deg.emplace()[1] = 31.5;  // as far as it goes
  lodestone::runs::RegionCoverage& coverage = evaluation.region_coverage.emplace();
  coverage.position[90].fraction = 0.875;
  coverage.position[90].interval = {0.861, 0.888};
  coverage.pose = coverage.position;
  coverage.pose->at(90).fraction = 0.75;
  const std::string html = lodestone::report::dynamics_section(run, "d");
  CHECK(holds(html, "of ten nearest neighbours</td><td class=\"number\">5.00</td><td class=\"number\">8.75"));
  CHECK(holds(html, "heading error (° RMS)</td><td class=\"number\">11.5</td><td class=\"number\">12.2"));
  CHECK(holds(html, "of ten nearest neighbours</td><td class=\"number\">31.5</td><td class=\"number\">–"));
  CHECK_FALSE(holds(html, "of no motion</td>"));
  CHECK(holds(html, "[2.0,8.75]"));  // a curve of their own
  CHECK_FALSE(holds(html, "Dashed lines: what the two baselines"));
  CHECK(holds(html, "the region that should hold (95 % interval)</th><th class=\"number\">90 %"));
  CHECK(holds(html, "position</td><td class=\"number\">87.5 % (86.1 to 88.8)"));
  CHECK(holds(html, "position and heading</td><td class=\"number\">75.0 % (86.1 to 88.8)"));
}

TEST_CASE("a likelihood does not stand beside the paper's distance") {
  lodestone::report::RunData run;
  lodestone::runs::DynamicsEvaluation& evaluation = run.evaluation.emplace();
  evaluation.normalised_l2 = 0.04;
  evaluation.training.emplace().validation_loss = 0.05;
  for (const int components : {0, 3}) {
    run.dynamics.config = {{"model", {{"components", components}}}};
    const std::string html = lodestone::report::dynamics_section(run, "d");
    CHECK(holds(html, "0.033") == (components == 0));
    CHECK(holds(html, "negative log-likelihood") == (components > 0));
    CHECK(holds(html, "0.045"));  // what is tested is a distance, whatever was learned
  }
}
