#include "lodestone/runs/compared_run.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/runs/rigs_result.h"
#include "runs/trial_records.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::point_trial;

TEST_CASE("a run is compared by the controller besides the baseline, or by the one that is named") {
  const tests::TemporaryFolder folder;
  const std::string run = folder / "a";
  tests::write_deployment(run, {point_trial(0, 1.0), point_trial(0, 2.0, "baseline"), point_trial(1, 1.5)},
                          2);
  const runs::ComparedRun policy = runs::read_compared_run(run);
  CHECK(policy.controller == "policy");
  CHECK(policy.per_rig == 2);
  CHECK(policy.trials.size() == 2);
  const runs::ComparedRun baseline = runs::read_compared_run(run + ":baseline");
  CHECK(baseline.name == run + ":baseline");
  CHECK(baseline.folder == run);
  REQUIRE(baseline.trials.size() == 1);
  CHECK(baseline.trials.front().sensed.final_error_mm == 2.0);
  CHECK_THROWS_WITH(runs::read_compared_run(run + ":planer"),
                    Catch::Contains("\"planer\" did not drive in") && Catch::Contains("baseline, policy"));
  tests::write_deployment(run, {point_trial(0, 1.0), point_trial(0, 2.0, "planner")});
  CHECK_THROWS_WITH(runs::read_compared_run(run), Catch::Contains("name one: " + run + ":planner"));
  tests::write_deployment(run, {point_trial(0, 1.0, "baseline")});
  CHECK(runs::read_compared_run(run).controller == "baseline");
}

TEST_CASE("the trials of both kinds of rig are read, also from the run that holds the deployment") {
  const tests::TemporaryFolder folder;
  tests::write_deployment(folder / "deploy/explored", {point_trial(0, 1.0, "policy", "explored")});
  tests::write_deployment(folder / "deploy/unseen", {point_trial(0, 2.0)});
  common::write_json(folder / "deploy/summary.json", common::Json::object());
  const runs::ComparedRun run = runs::read_compared_run(folder.path());
  REQUIRE(run.trials.size() == 2);
  CHECK(run.trials.front().rig == "explored");
  CHECK(run.trials.back().rig == "unseen");
}

TEST_CASE("a folder without trials says which it should have been, or that they are not all driven") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(runs::read_compared_run(folder / "none"), Catch::Contains("there is no folder"));
  CHECK_THROWS_WITH(runs::read_compared_run(folder.path()),
                    Catch::Contains("--out of deploy or of bench rigs"));
  common::write_file_atomically(folder / "trials.jsonl", "{}\n");
  CHECK_THROWS_WITH(runs::read_compared_run(folder.path()), Catch::Contains("not all been driven"));
  common::write_file_atomically(folder / runs::kTrialsFile, "[]");
  CHECK_THROWS_AS(runs::read_compared_run(folder.path()), common::DataError);
}
