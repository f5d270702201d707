#include "lodestone/report/tasks_report.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/tasks_result.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::holds;

namespace {

runs::TaskFigures figures(double error_mm) {
  runs::TaskFigures made;
  made.n_trials = 10;
  made.truth.emplace().mean_error_mm = error_mm;
  made.truth->rms_error_mm = error_mm;
  made.truth->success_rate = 0.9;
  made.mean_error_interval_mm = made.rms_error_interval_mm = {0.4, 0.6};
  made.success_interval = {0.6, 0.98};
  return made;
}

}  // namespace

TEST_CASE("a bench of tasks comes with its table, and the errors of a square by its speed") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_AS(report::write_tasks_report(folder.path(), folder / "report.html"), common::Error);
  runs::TasksSummary summary;
  summary.cells = 3;
  summary.cells_planned = 40;
  summary.alone["pose"]["planner"]["bare"] = figures(0.5);
  common::write_artefact(folder / runs::TasksSummary::kFile, summary);
  std::string text = report::write_tasks_report(folder.path(), folder / "report.html");
  CHECK(text ==
        "3 of 40 cells are finished\n"
        "pose                 planner   bare      error (mm): 0.50 (0.40 to 0.60); RMS error (mm): 0.50 "
        "(0.40 to "
        "0.60); success: 90.0 % (60.0 to 98.0); stopped: 0; trials: 10\n");
  std::string page = common::read_file(folder / "report.html");
  CHECK(holds(page, "3 of 40 cells"));
  CHECK(holds(page, "0.50 (0.40 to 0.60)"));
  CHECK_FALSE(holds(page, "heading RMS (degrees)"));
  CHECK_FALSE(holds(page, "in fluid at rest"));
  CHECK_FALSE(holds(page, "id=\"square-speed\""));

  summary.flow_speed_m_s = 0.0125;
  summary.square_speed_limit_m_s = 0.03125;
  runs::TaskFigures& flow = summary.groups["flow"]["point"]["baseline"]["decorated"] = figures(1.0);
  flow.ratio_to_still = 1.5;
  flow.ratio_to_still_interval = {1.25, 1.75};
  for (const char* speed_mm_s : {"2", "4", "6"})
    summary.groups["square_at_mm_s"][speed_mm_s]["planner"]["bare"] = figures(std::stod(speed_mm_s));
  common::write_artefact(folder / runs::TasksSummary::kFile, summary);
  text = report::write_tasks_report(folder.path(), folder / "report.html");
  CHECK(holds(text, "flow point           baseline  decorated"));
  CHECK(holds(text, "error / that in fluid at rest: 1.50 (1.25 to 1.75)"));
  CHECK(holds(text, "square_at_mm_s 6     planner"));
  page = common::read_file(folder / "report.html");
  CHECK(holds(page, "12.5 mm/s in the mean"));
  CHECK(holds(page, "id=\"square-speed\""));
  CHECK(holds(page, "planner, bare"));
  CHECK(holds(page, "Physics allows at least 31 mm/s (far to the right"));
  CHECK_FALSE(holds(page, "as fast as physics allows"));
  summary.square_speed_limit_m_s = 0.0125;
  common::write_artefact(folder / runs::TasksSummary::kFile, summary);
  report::write_tasks_report(folder.path(), folder / "report.html");
  page = common::read_file(folder / "report.html");
  CHECK(holds(page, "Physics allows at least 12 mm/s (drawn in)"));
  CHECK(holds(page, "as fast as physics allows"));
}
