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
}
