#include "lodestone/report/rigs_report.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/rigs_result.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("a bench of rigs comes with its table and a dot for each rig") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_AS(report::write_rigs_report(folder.path(), folder / "report.html"), common::Error);
  runs::RigsSummary summary;
  summary.rigs = 2;
  summary.trials_per_rig = 5;
  runs::RigsTaskSummary& square = summary.by_controller["planner"]["square"];
  square.n_trials = 10;
  square.truth.emplace().mean_error_mm = 0.45;
  square.truth->success_rate = 0.9;
  square.truth->time_rms_error_mm = 1.1;
  square.mean_error_interval_mm = {0.41, 0.52};
  square.success_interval = {0.8, 1.0};
  square.time_rms_error_interval_mm = {1.0, 1.2};
  square.worst = {1, 0.5};
  square.minus_baseline_mm = -2.5;
  square.minus_baseline_interval_mm = {-3.0, -2.0};
  common::write_artefact(folder / runs::RigsSummary::kFile, summary);
  runs::RigsResult result;
  result.rigs.resize(2);
  result.rigs[1].moment = 1.5;
  for (runs::RigFigures& rig : result.rigs) rig.mean_error_mm["planner"]["square"] = 0.45;
  common::write_artefact(folder / runs::RigsResult::kFile, result);

  const std::string text = report::write_rigs_report(folder.path(), folder / "report.html");
  CHECK(text ==
        "square  planner   error 0.45 (0.41 to 0.52) mm, success 90.0 % (80.0 to 100.0), moving reference "
        "1.10 (1.00 to 1.20) mm; worst rig 0.50, rig 1; against the baseline -2.50 (-3.00 to -2.00) mm; 0 of "
        "10 trials stopped\n");
  const std::string page = common::read_file(folder / "report.html");
  CHECK(tests::holds(page, "Controllers on 2 rigs"));
  CHECK(tests::holds(page, "0.45 (0.41 to 0.52)"));
  CHECK(tests::holds(page, "id=\"square-moment\""));
  CHECK_FALSE(tests::holds(page, "id=\"point-moment\""));
  CHECK_FALSE(tests::holds(page, "id=\"square-minutes\""));
  CHECK(tests::holds(page, "against the baseline (mm)"));
  CHECK_FALSE(tests::holds(page, "against identified only (mm)"));  // nothing was learned
  CHECK_FALSE(tests::holds(page, "heading RMS (degrees)"));

  square.truth->heading_rms_deg = 9.5;
  square.heading_rms_interval_deg = {8.0, 11.0};
  common::write_artefact(folder / runs::RigsSummary::kFile, summary);
  CHECK(tests::holds(report::write_rigs_report(folder.path(), folder / "report.html"),
                     "mm, heading 9.5 (8.0 to 11.0) degrees; worst rig"));
  CHECK(tests::holds(common::read_file(folder / "report.html"), "heading RMS (degrees)"));
}

TEST_CASE("what was learned of the rigs stands over the minutes that it took") {
  const tests::TemporaryFolder folder;
  runs::RigsSummary summary;
  summary.rigs = 2;
  summary.trials_per_rig = 5;
  summary.learned["adapted_1000"] = {1000, 5.0, 2, 1, 0, 26.0};
  summary.learned["from_scratch_300"] = {300, 1.5, 2, 2, 0, 5.0};
  for (const char* name : {"planner", "adapted_1000", "from_scratch_300"}) {
    runs::RigsTaskSummary& point = summary.by_controller[name]["point"];
    point.n_trials = 10;
    point.truth.emplace().mean_error_mm = 0.45;
    point.mean_error_interval_mm = {0.41, 0.52};
  }
  summary.by_controller["adapted_1000"]["point"].minus_planner_mm = -0.021;
  summary.by_controller["adapted_1000"]["point"].minus_planner_interval_mm = {-0.03, -0.012};
  common::write_artefact(folder / runs::RigsSummary::kFile, summary);
  const auto read = common::read_artefact<runs::RigsSummary>(folder / runs::RigsSummary::kFile);
  CHECK(read.controllers() == std::vector<std::string>{"planner", "from_scratch_300", "adapted_1000",
                                                       "policy", "baseline", "observer"});
  CHECK(read.by_controller.at("adapted_1000").at("point").n_trials == 10);
  common::write_artefact(folder / runs::RigsResult::kFile, runs::RigsResult());

  const std::string text = report::write_rigs_report(folder.path(), folder / "report.html");
  CHECK(tests::holds(text, "against identified only -0.021 (-0.030 to -0.012) mm"));
  CHECK(tests::holds(
      text, "adapted_1000: 2 rigs, 5.0 minutes of each, kept on 1, 0 placements, 26 s of computing"));
  const std::string page = common::read_file(folder / "report.html");
  CHECK(tests::holds(page, "id=\"point-minutes\""));
}
