#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using lodestone::tests::holds;

TEST_CASE("predictions are held against what happened, and baselines are named where there are any") {
  lodestone::report::RunData run;
  CHECK(holds(lodestone::report::dynamics_section(run, "d"), "lodestone train-dynamics"));
  lodestone::runs::DynamicsEvaluation& evaluation = run.evaluation.emplace();
  evaluation.one_step.position_rms_mm = 2.5;
  evaluation.k_step_mm = {{1, 2.5}, {2, 4.0}};
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
}
