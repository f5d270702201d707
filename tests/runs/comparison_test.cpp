#include "lodestone/runs/comparison.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "runs/trial_records.h"

using namespace lodestone;
using runs::ComparedRun;
using tests::point_trial;

namespace {

/// Trials with these errors.
ComparedRun run_of(const std::string& name, const std::vector<double>& errors_mm,
                   const std::string& rig = "unseen", std::int64_t per_rig = 0) {
  ComparedRun run{name, name, "policy", per_rig, {{"seed", 1}, {"threads", errors_mm.size()}}, {}};
  for (std::size_t trial = 0; trial < errors_mm.size(); ++trial)
    run.trials.push_back(point_trial(static_cast<std::int64_t>(trial), errors_mm[trial], "policy", rig));
  return run;
}

std::vector<double> plus(std::vector<double> values, double more) {
  for (double& value : values) value += more;
  return values;
}

const std::vector<double> kErrors_mm = {1.0, 0.4, 2.1, 0.8, 1.6, 0.9, 1.1, 0.5};

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("what differs in every trial alike is told, with what it is held against") {
  const auto comparison = runs::compare_runs({run_of("A", kErrors_mm), run_of("B", plus(kErrors_mm, -0.3))});
  REQUIRE(comparison.rows.size() == 1);
  const runs::ComparisonRow& row = comparison.rows.front();
  CHECK(row.error_mm.pairs == 8);
  CHECK(row.error_mm.units == 8);
  CHECK(row.error_mm.first == Approx(1.05));
  CHECK(row.error_mm.other == Approx(0.75));
  CHECK(row.error_mm.difference == Approx(-0.3));
  CHECK(row.error_mm.signed_rank_p < 0.01);
  CHECK(row.failed.other == 0.0);
  REQUIRE(row.seconds_to_reach);
  CHECK(row.seconds_to_reach->difference == Approx(-0.3));
  CHECK_FALSE(row.completion);
  CHECK(holds(row.sentence,
              "point, unseen: the error of B is 0.30 mm smaller than that of A (95 %: 0.30 to 0.30)"));
  CHECK(holds(row.sentence, "none fails (8 trials)"));
  CHECK(comparison.settings.empty());  // another number of threads changes nothing
}

TEST_CASE("a difference that may be chance is not told as one") {
  common::RandomStream random(1, "scatter");
  int told = 0;
  for (int run = 0; run < 100; ++run) {
    std::vector<double> first, other;
    for (int trial = 0; trial < 20; ++trial) {
      const double common_mm = 1.0 + random.uniform(0.0, 1.0);
      first.push_back(common_mm + random.uniform(0.0, 0.5));
      other.push_back(common_mm + random.uniform(0.0, 0.5));
    }
    const auto row = runs::compare_runs({run_of("A", first), run_of("B", other)}).rows.front();
    if (!holds(row.sentence, "not told apart")) ++told;
  }
  CHECK(told >= 1);
  CHECK(told <= 13);  // of 95 % intervals, 5 of 100 miss; 13 has a chance below 0.1 %
}

TEST_CASE("six trials are enough for a sentence only where all of them say the same") {
  common::RandomStream random(2, "scatter");
  int told = 0;
  for (int run = 0; run < 200; ++run) {
    std::vector<double> first, other;
    for (int trial = 0; trial < 6; ++trial) {
      first.push_back(1.0 + random.uniform(0.0, 0.5));
      other.push_back(1.0 + random.uniform(0.0, 0.5));
    }
    const auto row = runs::compare_runs({run_of("A", first), run_of("B", other)}).rows.front();
    if (!holds(row.sentence, "not told apart")) ++told;
  }
  CHECK(told >= 1);
  CHECK(told <= 16);  // the test's chance is 2 of 64: 6 are expected; an interval alone would tell some 20
  const std::vector<double> six(kErrors_mm.begin(), kErrors_mm.begin() + 6);
  CHECK(holds(runs::compare_runs({run_of("A", six), run_of("B", plus(six, 0.1))}).rows.front().sentence,
              "0.10 mm larger"));
  std::vector<double> five_of_six = plus(six, 0.1);
  five_of_six[0] -= 0.15;  // the smallest difference, and the only one below zero
  const auto row = runs::compare_runs({run_of("A", six), run_of("B", five_of_six)}).rows.front();
  CHECK(row.error_mm.interval[0] > 0.0);
  CHECK(holds(row.sentence, "not told apart"));
}

TEST_CASE("a run that fails more often is not simply better, however close its errors are") {
  // B is stopped close to the target in three of eight: a stopped needle can have a small error.
  std::vector<double> errors_mm = plus(kErrors_mm, -0.3);
  ComparedRun other = run_of("B", errors_mm);
  for (std::size_t trial = 0; trial < 6; ++trial) {
    other.trials[trial].completed = false;
    other.trials[trial].sensed.success = false;
    other.trials[trial].sensed.seconds_to_reach.reset();
  }
  const auto row = runs::compare_runs({run_of("A", kErrors_mm), other}).rows.front();
  CHECK(row.stopped.other == Approx(0.75));
  CHECK(row.failed.larger());
  CHECK(holds(row.sentence, "but it fails more often: 75.0 % against 0.0 %"));
  REQUIRE(row.error_of_successes_mm);
  CHECK(row.error_of_successes_mm->pairs == 2);
}

TEST_CASE("trials of one rig are one unit, and few units say nothing") {
  std::vector<double> first, other;
  for (int trial = 0; trial < 20; ++trial) {
    first.push_back(1.0);
    other.push_back(trial < 5 ? 0.5 : 1.1);  // the first of four rigs likes it
  }
  const auto shared = runs::compare_runs({run_of("A", first, "unseen", 5), run_of("B", other, "unseen", 5)});
  const runs::ComparisonRow& row = shared.rows.front();
  CHECK(row.rigs_are_units);
  CHECK(row.error_mm.units == 4);
  CHECK(row.error_mm.pairs == 20);
  CHECK(row.error_mm.difference == Approx(0.25 * (-0.5 + 3 * 0.1)));
  CHECK(holds(row.sentence, "4 rigs, 20 trials are too few to say anything"));
  const auto alone =
      runs::compare_runs({run_of("A", first, "explored", 5), run_of("B", other, "explored", 5)});
  CHECK(alone.rows.front().error_mm.units == 20);
  CHECK(alone.rows.front().one_rig);
  CHECK(holds(alone.rows.front().sentence, "20 trials on one rig"));
}

TEST_CASE("only trials that both have are counted, and runs that share none are no pair") {
  ComparedRun other = run_of("B", plus(kErrors_mm, 0.1));
  other.trials[0].target_mm = runs::PointMm{9.0, 9.0};  // another place than A's
  other.trials.pop_back();
  const auto row = runs::compare_runs({run_of("A", kErrors_mm), other}).rows.front();
  CHECK(row.error_mm.pairs == 6);
  CHECK(row.left_out == 3);  // A's first and last, B's first
  ComparedRun headed = run_of("B", plus(kErrors_mm, 0.1));
  for (std::size_t i = 0; i < 2; ++i)  // the needle was to lie otherwise
    headed.trials[i].reference_heading_rad = std::vector<double>{0.5};
  CHECK(runs::compare_runs({run_of("A", kErrors_mm), headed}).rows.front().error_mm.pairs == 6);
  for (runs::TrialRecord& trial : other.trials) trial.start[0] += 0.1;
  CHECK_THROWS_WITH(runs::compare_runs({run_of("A", kErrors_mm), other}),
                    Catch::Contains("B shares no trial with A"));
  CHECK_THROWS_WITH(runs::compare_runs({run_of("A", kErrors_mm)}), Catch::Contains("two runs"));
  CHECK_THROWS_WITH(runs::compare_runs({run_of("A", kErrors_mm), run_of("A", kErrors_mm)}),
                    Catch::Contains("A is named twice"));
  CHECK_THROWS_WITH(runs::compare_runs({run_of("A", kErrors_mm, "unseen", 2), run_of("B", kErrors_mm)}),
                    Catch::Contains("their rigs are not the same"));
}

TEST_CASE("what the runs were told otherwise is listed, and whether it changes the trials") {
  ComparedRun first = run_of("A", kErrors_mm), other = run_of("B", kErrors_mm),
              third = run_of("C", kErrors_mm);
  first.config = {{"policy", "x"}, {"rig", {{"supply_V", 34.0}}}, {"trials", {{"count", 8}}}};
  other.config = {{"policy", "y"}, {"rig", {{"supply_V", 24.0}}}, {"trials", {{"count", 9}}}};
  third.config = first.config;
  const auto comparison = runs::compare_runs({first, other, third});
  CHECK(comparison.rows.size() == 2);
  CHECK(comparison.rows.back().other == 2);
  REQUIRE(comparison.settings.size() == 3);
  CHECK(comparison.settings[0].key == "policy");
  CHECK_FALSE(comparison.settings[0].of_the_trials);
  CHECK(comparison.settings[1].key == "rig.supply_V");
  CHECK(comparison.settings[1].values == std::vector<std::string>{"34.0", "24.0", "34.0"});
  CHECK(comparison.settings[1].of_the_trials);
  CHECK_FALSE(comparison.settings[2].of_the_trials);
  auto copy = comparison;
  const common::Json json = common::artefact_to_json(copy);
  auto back = common::artefact_from_json<runs::Comparison>(json, "test");
  CHECK(common::artefact_to_json(back) == json);
}
