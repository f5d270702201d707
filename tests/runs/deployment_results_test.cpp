#include "lodestone/runs/deployment_results.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using common::Json;

namespace {

runs::TrialRecord record(bool known) {
  runs::TrialRecord made;
  made.task = "square";
  made.controller = "planner";
  made.rig = known ? "unseen" : "real";
  made.trial = 3;
  made.start = {1.0, -2.0, 0.5};
  made.path_mm = {{0.0, 0.0}, {15.0, 0.1}};
  made.time_s = {0.0, 0.3};
  made.sensed_trajectory = {runs::PoseMm{1.1, -2.0, 0.5}, std::nullopt};
  made.reference_heading_rad = std::vector<double>{0.1, 1.0 / 3.0};
  made.approach = {1, 0};
  made.sensed.corner_errors_mm = {0.1, 1.0 / 3.0};
  made.sensed.cross_track_rms_mm = 0.2;
  made.sensed.heading_rms_deg = 7.5;
  if (!known) return made;
  made.trajectory = {{1.0, -2.0, 0.5}, {1.5, -2.0, 0.5}};
  made.truth = made.sensed;
  made.truth->final_error_mm = 0.25;
  made.truth->clearance_mm = -0.5;
  made.truth->touches = 2;
  made.obstacles_mm = {{10.0, 1.0 / 3.0, 3.0}};
  made.unreachable = false;
  made.stitches.emplace().push_back({{-8.0, -3.0, 1.5}, {-8.0, 3.0, 1.0 / 3.0}});
  made.truth->stitches_made = 1;
  made.truth->stitches_made_share = 1.0;
  made.truth->stitch_rms_mm = 0.5;
  made.truth->stitch_figures.emplace().push_back({true, 0.25, 1.0, 1.0 / 3.0, 7.5});
  return made;
}

}  // namespace

TEST_CASE("trials read back to the last digit, and one without a true pose has no true figure") {
  const tests::TemporaryFolder folder;
  CHECK_FALSE(runs::find_trials(folder.path()));
  const Json list =
      Json::array({common::artefact_to_json(record(true)), common::artefact_to_json(record(false))});
  common::write_json(folder / runs::kTrialsFile, list);
  const auto trials = runs::find_trials(folder.path());
  REQUIRE(trials);
  REQUIRE(trials->size() == 2);
  CHECK(common::artefact_to_json(trials->at(0)) == list[0]);
  CHECK(trials->at(0).figures().final_error_mm == 0.25);
  CHECK(trials->at(0).truth->corner_errors_mm->at(1) == 1.0 / 3.0);
  CHECK(trials->at(0).truth->touches == 2);
  CHECK(trials->at(0).obstacles_mm->front()[1] == 1.0 / 3.0);
  CHECK(trials->at(0).unreachable == false);
  CHECK_FALSE(trials->at(1).unreachable);
  CHECK(trials->at(0).stitches == record(true).stitches);
  CHECK(trials->at(0).truth->stitch_figures->at(0).exit_error_mm == 1.0 / 3.0);
  CHECK(trials->at(0).truth->stitches_made == 1);
  CHECK(trials->at(0).truth->error_mm() == 0.2);  // the cross-track RMS, where there is one
  CHECK_FALSE(trials->at(1).stitches);
  CHECK_FALSE(trials->at(1).sensed.clearance_mm);
  CHECK_FALSE(trials->at(1).truth);
  CHECK_FALSE(trials->at(1).trajectory);
  CHECK_FALSE(list[1].contains("final_error_mm"));
  CHECK(trials->at(1).figures().cross_track_rms_mm == 0.2);
  CHECK(trials->at(1).figures().heading_rms_deg == 7.5);
  CHECK(trials->at(0).reference_heading_rad->at(1) == 1.0 / 3.0);
  common::write_file_atomically(folder / runs::kTrialsFile, "[{\"task\": \"point\"}]");
  CHECK_THROWS_WITH(runs::find_trials(folder.path()), Catch::Contains("trials.json: rig is missing"));
  runs::TrialRecord short_by_one = record(true);
  short_by_one.approach->pop_back();
  common::write_json(folder / runs::kTrialsFile, Json::array({common::artefact_to_json(short_by_one)}));
  CHECK_THROWS_WITH(runs::find_trials(folder.path()),
                    Catch::Contains("trials.json: trial 3: approach has 1 rows for 2 observations"));
  short_by_one = record(true);
  short_by_one.reference_heading_rad->pop_back();
  common::write_json(folder / runs::kTrialsFile, Json::array({common::artefact_to_json(short_by_one)}));
  CHECK_THROWS_WITH(runs::find_trials(folder.path()),
                    Catch::Contains("trial 3: reference_heading_rad has 1 rows for 2 observations"));
}

TEST_CASE("a map of what can be reached reads back") {
  const tests::TemporaryFolder folder;
  runs::ReachMap map;
  map.cell_mm = 4.0;
  map.reachable_mm = {{2.0, 2.0}, {6.0, 1.0 / 3.0}};
  map.dead_mm = {{38.0, -2.0}};
  common::write_artefact(folder / runs::ReachMap::kFile, map);
  const auto read = common::read_artefact<runs::ReachMap>(folder / runs::ReachMap::kFile);
  CHECK(read.cell_mm == 4.0);
  CHECK(read.reachable_mm == map.reachable_mm);
  CHECK(read.dead_mm == map.dead_mm);
}

TEST_CASE("a summary has the tasks of the first rig at its top, each rig by name, and the baseline apart") {
  runs::TaskSummary square;
  square.n_trials = 2;
  square.truth.emplace().mean_error_mm = 1.5;
  runs::DeploymentSummary summary;
  summary.controller = "planner";
  summary.tasks.by_task["square"] = square;
  summary.baseline.emplace().by_task["square"] = square;
  summary.by_rig["unseen"] = summary;
  summary.provenance.collect.emplace().transitions = 800;
  const Json json = common::artefact_to_json(summary);
  CHECK(json["controller"] == "planner");
  CHECK(json["square"]["mean_error_mm"] == 1.5);
  CHECK(json["square"]["n_trials"] == 2);
  CHECK(json["baseline"]["square"]["mean_error_mm"] == 1.5);
  CHECK(json["unseen"]["square"]["mean_error_mm"] == 1.5);
  CHECK(json["collect"]["transitions"] == 800);
  CHECK_FALSE(json.contains("stopped"));
  CHECK_FALSE(json.contains("explored"));
  CHECK(common::artefact_to_json(common::artefact_from_json<runs::DeploymentSummary>(json, "summary.json")) ==
        json);
}
