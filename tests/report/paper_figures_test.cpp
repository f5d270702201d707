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
  REQUIRE(planner.from_reference_mm);
  CHECK(*planner.from_reference_mm == Approx((-1.0 - 2.0 - 1.5 - 5.5) / 4.0));
  CHECK((*planner.from_reference_interval_mm)[1] < 0.0);
  CHECK(planner.n_shared_trials == 4);
  CHECK_FALSE(result.transfer.at("baseline").at("bare").at("centre").from_reference_mm);
}

TEST_CASE("what only paths have has an interval, and the paper's measure is paired with the pull's, too") {
  Kept made;
  made.add_trials("transfer/baseline/bare/square/1", 11, {3.0, 5.0});
  made.add_trials("transfer/planner/bare/square/1", 11, {1.0, 2.0});
  made.kept.records["transfer/baseline/bare/square/1"].trials->target_deviation_mm = {3.0, 4.0};
  runs::KeptTrials& planner = *made.kept.records["transfer/planner/bare/square/1"].trials;
  planner.target_deviation_mm = {1.0, 1.0};
  planner.completion = {0.5, 1.0};
  const runs::PaperResult result = report::paper_figures(made.kept);
  const runs::PooledErrors& errors = result.transfer.at("planner").at("bare").at("square");
  CHECK(*errors.from_reference_mm == Approx(-2.5));
  CHECK(*errors.target_deviation_from_reference_mm == Approx(-2.5));
  CHECK(errors.target_deviation_from_reference_interval_mm == std::array<double, 2>{-3.0, -2.0});
  CHECK(*errors.completion == Approx(0.75));
  CHECK(errors.completion_interval == std::array<double, 2>{0.5, 1.0});
  CHECK_FALSE(errors.corners_interval);
}

TEST_CASE("over the whole dish a row is paired with the pull on those trials, and learned with plain") {
  Kept made;
  made.add_trials("transfer/baseline/bare/point/1", 11, {2.0, 4.0});
  made.add_trials("transfer/baseline/whole_dish/point/1", 11, {5.0, 7.0});
  made.add_trials("transfer/paper/whole_dish/point/1", 11, {6.0, 10.0});
  made.add_trials("transfer/paper_simulator/whole_dish/point/1", 11, {9.0, 11.0});
  const runs::PaperResult result = report::paper_figures(made.kept);
  CHECK(*result.transfer.at("paper").at("whole_dish").at("point").from_reference_mm == Approx(2.0));
  CHECK_FALSE(result.transfer.at("baseline").at("whole_dish").at("point").from_reference_mm);
  CHECK(result.learned_minus_plain.at("paper").at("whole_dish").at("point").error_mm.mean == Approx(-2.0));
}

TEST_CASE("the time to the maximum is that of a training that has come there") {
  Kept made;
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add_training("policy/paper/centre/1", tests::kRising);
  const runs::PaperResult result = report::paper_figures(made.kept);
  const runs::PooledTraining& risen = result.training.at("best").at("centre");
  CHECK(risen.n_converged == 1);
  REQUIRE(risen.seconds_to_maximum);
  CHECK(*risen.seconds_to_maximum ==
        Approx(50.0));  // of 8, 10, 10, 10 and 10, whose mean is 9.6, the first 10
  CHECK(risen.lowest_return == 0.0);
  CHECK(risen.highest_return == 10.0);
  CHECK(risen.success_rate == Approx(0.8));
  const runs::PooledTraining& rising = result.training.at("paper").at("centre");
  CHECK(rising.n_converged == 0);
  CHECK_FALSE(rising.seconds_to_maximum);
}

TEST_CASE("one lucky evaluation is not the maximum, and a return that falls back is counted") {
  Kept made;
  std::vector<double> lucky = tests::kRisen, fallen = tests::kRisen;
  lucky[1] = 10.0;  // alone, before the rise
  fallen[18] = 6.0;
  fallen[19] = 5.0;
  made.add_training("policy/best/centre/1", lucky);
  made.add_training("policy/paper/centre/1", fallen);
  const runs::PaperResult result = report::paper_figures(made.kept);
  CHECK(result.training.at("best").at("centre").n_fallen == 0);
  CHECK(*result.training.at("best").at("centre").steps_to_maximum == Approx(500.0));
  CHECK(result.training.at("paper").at("centre").n_fallen == 1);
  CHECK(result.training.at("paper").at("centre").n_converged == 1);
}

TEST_CASE("trainings are compared over the seeds that both have") {
  Kept made;
  std::vector<double> higher = tests::kRisen, easy = tests::kRisen, easy_higher = tests::kRisen;
  for (double& value : higher) value += 1.0;
  for (double& value : easy) value += 100.0;  // a simulator in which everybody earns more
  for (double& value : easy_higher) value += 102.0;
  made.add_training("mix/0/1", tests::kRisen);
  made.add_training("mix/0/2", easy);
  made.add_training("mix/0/3", easy);
  made.add_training("mix/1/1", higher);
  made.add_training("mix/1/2", easy_higher);
  made.add_training("open/short_episodes_kept/mix/1/2", easy);
  made.add_training("policy/paper/centre/1", tests::kRisen);
  made.add_training("open/reward_in_mm/policy/2", easy);
  const runs::PaperResult result = report::paper_figures(made.kept);
  const runs::TrainingDifference& one = result.mix_differences.at("1");
  CHECK(one.n_seeds == 2);
  CHECK(one.final_return == Approx(1.5));
  REQUIRE(one.final_return_interval);
  CHECK((*one.final_return_interval)[0] == Approx(1.5 - 12.706205 * 0.5));
  const runs::TrainingDifference& kept = result.open_differences.at("short episodes kept, 1 of 3");
  CHECK(kept.final_return == Approx(-2.0));
  CHECK_FALSE(kept.final_return_interval);
  CHECK(result.open_differences.count("reward in mm") == 0);  // no seed that both have
}

TEST_CASE("an ablation stands beside the best preset on the same trials") {
  Kept made;
  made.add_trials("ablation/best_preset/point/1", 7, {2.0, 4.0});
  made.add_trials("ablation/without_memory/point/1", 7, {5.0, 5.0});
  made.add_trials("ablation/without_memory/point/2", 8, {9.0, 9.0});
  const runs::PaperResult result = report::paper_figures(made.kept);
  const runs::PooledErrors& without = result.ablations.at("without memory").at("point");
  CHECK(*without.from_reference_mm == Approx(2.0));
  CHECK(without.n_shared_trials == 2);
  CHECK(without.n_trials == 4);
  CHECK_FALSE(result.ablations.at("best preset").at("point").from_reference_mm);
}
