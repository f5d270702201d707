#include "lodestone/runs/cell_record.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using common::artefact_to_json;
using tests::cell;
using tests::plan;

TEST_CASE("a training's record holds its result and its curve, to six digits") {
  const tests::TemporaryFolder folder;
  const runs::Plan made = plan({cell("a")});
  const runs::PlanPlace place{folder.path(), "lodestone", "configs"};
  common::make_folders(folder / "a");
  runs::PolicyResult result;
  result.env_steps = 200;
  common::write_artefact(folder / "a/result.json", result);
  common::write_file_atomically(
      folder / "a/metrics.jsonl",
      "{\"step\":0,\"evaluation/episode_return\":-1.23456789,\"evaluation/success_rate\":0}\n"
      "{\"step\":50,\"train/critic_loss\":1}\n"
      "{\"step\":100,\"evaluation/episode_return\":2,\"evaluation/success_rate\":0.5,"
      "\"train/seconds\":10,\"train/processor_seconds\":9}\n");
  common::write_file_atomically(
      folder / "a/manifest.json",
      "{\"verb\":\"x\",\"host\":\"secret\",\"git_commit\":\"abc\",\"threads\":1,\"continued\":["
      "{\"host\":\"secret\",\"git_commit\":\"def\",\"threads\":4},"
      "{\"host\":\"secret\",\"git_commit\":\"abc\",\"threads\":2}]}");
  const runs::CellRecord record = runs::record_of(made, place, made.cells[0]);
  REQUIRE(record.curve);
  CHECK(record.curve->env_steps == std::vector<double>{0, 100});
  CHECK(record.curve->episode_return == std::vector<double>{-1.23457, 2});
  CHECK(record.curve->processor_seconds == std::vector<double>{0, 9});
  CHECK(record.machine["git_commit"] == "abc");
  CHECK(record.machine.dump().find("secret") == std::string::npos);
  CHECK(record.manifest_texts("git_commit") == std::vector<std::string>{"abc", "def"});
  CHECK(record.manifest_texts("processor") == std::vector<std::string>{"unknown"});
  CHECK(record.threads() == 4);
  CHECK(runs::CellRecord().manifest_texts("git_commit") == std::vector<std::string>{"unknown"});
  const auto again = common::artefact_from_json<runs::CellRecord>(artefact_to_json(record), "record");
  CHECK(artefact_to_json(again) == artefact_to_json(record));
}

TEST_CASE("a run is one of a cell when it has its preset's values and its settings, whatever else it has") {
  const common::Json config = {
      {"task", {{"goal", "point"}, {"alpha", -10.0}}}, {"dynamics", "/x/y"}, {"steps", 3}, {"on", "unseen"}};
  const common::Json preset = {{"task", {{"goal", "point"}, {"alpha", -5}}}, {"steps", 3}};
  const auto is = [&](std::vector<std::string> settings) {
    return runs::is_run_of(config, cell("a", std::move(settings)), preset);
  };
  CHECK(is({"task.alpha=-10", "dynamics={other}/checkpoint", "on=unseen"}));
  CHECK_FALSE(is({}));  // the preset's alpha
  CHECK_FALSE(is({"task.alpha=-10", "steps=4"}));
  CHECK_FALSE(is({"task.alpha=-10", "gone=1"}));
  CHECK_FALSE(is({"task.alpha=-10", "on=explored"}));
}

TEST_CASE("a deployment's record holds every trial's figures, and as many drawings as asked for") {
  const tests::TemporaryFolder folder;
  runs::Plan made = plan({cell("a")});
  made.cells[0].verb = "deploy";
  made.cells[0].drawn_trials = 1;
  common::Json trials = common::Json::array();
  for (const double error_mm : {1.0, 5.0}) {
    runs::TrialRecord trial;
    trial.task = "square";
    trial.controller = "planner";
    trial.trajectory = {{1.23456, 0.0, 0.0}, {2.0, 0.0, 0.0}};
    trial.current_A.emplace(2);
    trial.completed = error_mm < 3.0;
    trial.truth.emplace().cross_track_rms_mm = error_mm;
    trial.truth->success = error_mm < 3.0;
    trial.truth->completion = 0.9;
    trials.push_back(artefact_to_json(trial));
  }
  common::make_folders(folder / "a");
  common::write_file_atomically(folder / "a/trials.json", trials.dump());
  const runs::CellRecord record =
      runs::record_of(made, {folder.path(), "lodestone", "configs"}, made.cells[0]);
  REQUIRE(record.trials);
  CHECK(record.trials->error_mm == std::vector<double>{1.0, 5.0});
  CHECK(record.trials->success == std::vector<int>{1, 0});
  CHECK(record.trials->stopped == std::vector<int>{0, 1});
  CHECK(record.trials->completion == std::vector<double>{0.9, 0.9});
  REQUIRE(record.trials->drawn.size() == 1);
  CHECK(record.trials->drawn[0].trajectory->at(0)[0] == Approx(1.23));
  CHECK_FALSE(record.trials->drawn[0].current_A);
}
