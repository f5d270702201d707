#include "lodestone/report/paper_figures.h"

#include <catch2/catch.hpp>

#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("errors are pooled over what is there, and paired with the bare baseline's") {
  Kept made;
  made.add_trials("transfer/baseline/bare/centre/1", 11, {2.0, 4.0});
  made.add_trials("transfer/baseline/bare/centre/2", 12, {5.0, 7.0});
  made.add_trials("transfer/planner/identified/centre/1", 11, {1.0, 2.0});
  made.add_trials("transfer/planner/identified/centre/2", 12, {3.5, 1.5});
  made.add("transfer/planner/identified/centre/3", false);
  const runs::PaperResult result = report::paper_figures(made.kept);
  CHECK(result.n_cells == 4);
  CHECK(result.n_cells_planned == 5);
  const runs::PooledErrors& planner = result.transfer.at("planner").at("identified").at("centre");
  CHECK(planner.n_trials == 4);
  CHECK(planner.origin.n_seeds == 2);
  CHECK(planner.origin.n_seeds_planned == 3);
  CHECK(planner.origin.commits == std::vector<std::string>{"abc"});
  CHECK(planner.mean_error_mm == Approx(2.0));
  CHECK(planner.success_rate == Approx(0.75));
  CHECK(planner.success_interval[0] <= 0.3006);  // Wilson's, 3 of 4
  REQUIRE(planner.from_baseline_mm);
  CHECK(*planner.from_baseline_mm == Approx((-1.0 - 2.0 - 1.5 - 5.5) / 4.0));
  CHECK((*planner.from_baseline_interval_mm)[1] < 0.0);
  CHECK_FALSE(result.transfer.at("baseline").at("bare").at("centre").from_baseline_mm);
}

TEST_CASE("the time to the maximum is that of a training that has come there") {
  Kept made;
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add_training("policy/paper/centre/1", tests::kRising);
  const runs::PaperResult result = report::paper_figures(made.kept);
  const runs::PooledTraining& risen = result.training.at("best").at("centre");
  CHECK(risen.n_converged == 1);
  REQUIRE(risen.seconds_to_maximum);
  CHECK(*risen.seconds_to_maximum == Approx(80.0));  // 8, 10, 10, 10 and 10 are smoothed to 9.6
  CHECK(*risen.processor_seconds_to_maximum == Approx(72.0));
  CHECK(risen.success_rate == Approx(0.8));
  const runs::PooledTraining& rising = result.training.at("paper").at("centre");
  CHECK(rising.n_converged == 0);
  CHECK_FALSE(rising.seconds_to_maximum);
}
