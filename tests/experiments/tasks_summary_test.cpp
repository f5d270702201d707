#include "lodestone/experiments/tasks_summary.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/runs/run_folder.h"
#include "runs/trial_records.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

std::vector<runs::TrialRecord> trials(const std::vector<double>& errors_mm) {
  std::vector<runs::TrialRecord> made;
  for (const double error_mm : errors_mm)
    made.push_back(tests::point_trial(static_cast<std::int64_t>(made.size()), error_mm));
  return made;
}

runs::Cell cell(const std::string& id) {
  runs::Cell made;
  made.id = id;
  made.verb = "deploy";
  return made;
}

/// A finished run of a cell.
void finish(const runs::Plan& plan, const runs::PlanPlace& place, const std::string& id,
            const std::vector<double>& errors_mm) {
  const std::string folder = runs::cell_folder(plan, place, id);
  runs::RunFolder run({folder, "deploy", common::Json::object(), 1, /*resume=*/true});
  run.begin();
  tests::write_deployment(folder, trials(errors_mm));
  run.finish();
}

}  // namespace

TEST_CASE("a task's figures have intervals, and what was not measured is absent") {
  const runs::TaskFigures figures = experiments::task_figures(trials({1.0, 2.0, 3.0, 6.0}));
  CHECK(figures.n_trials == 4);
  CHECK(figures.errors().mean_error_mm == Approx(3.0));
  CHECK(figures.mean_error_interval_mm[0] >= 1.0);
  CHECK(figures.mean_error_interval_mm[0] < 3.0);
  CHECK(figures.mean_error_interval_mm[1] > 3.0);
  CHECK(figures.rms_error_interval_mm[1] > figures.mean_error_interval_mm[0]);
  CHECK(figures.success_interval[0] == Approx(0.301).margin(0.001));  // Wilson, three of four
  CHECK(figures.success_interval[1] == Approx(0.954).margin(0.001));
  CHECK_FALSE(figures.heading_rms_interval_deg);
  CHECK_FALSE(figures.unreachable_rate);
  CHECK_FALSE(figures.ratio_to_still);
  const common::Json json = common::artefact_to_json(figures);
  CHECK(common::artefact_to_json(common::artefact_from_json<runs::TaskFigures>(json, "figures")) == json);
}

TEST_CASE("layouts without a way are told apart from those that were driven") {
  std::vector<runs::TrialRecord> made = trials({1.0, 9.0, 9.0, 1.0});
  for (runs::TrialRecord& trial : made) trial.unreachable = false;
  made[1].unreachable = true;
  runs::TaskFigures figures = experiments::task_figures(made);
  CHECK(figures.unreachable == 1);
  CHECK(*figures.unreachable_rate == Approx(0.25));
  CHECK(*figures.reachable_success_rate == Approx(2.0 / 3.0));
  CHECK(figures.reachable_success_interval->at(1) < 1.0);
  for (runs::TrialRecord& trial : made) trial.unreachable = true;
  figures = experiments::task_figures(made);
  CHECK(*figures.unreachable_rate == 1.0);
  CHECK_FALSE(figures.reachable_success_rate);
}

TEST_CASE("finished cells stand under the names of their tasks, beside what they are compared with") {
  const tests::TemporaryFolder folder;
  runs::Plan plan;
  plan.subfolder = "cells";
  for (const char* id : {"pose/planner/bare", "still/point/planner/bare", "flow/point/planner/bare",
                         "flow/point/baseline/bare", "still/square/planner/bare", "pose/planner/decorated",
                         "flow/point/oracle/bare"})
    plan.cells.push_back(cell(id));
  plan.cells[2].settings = {"rig.simulation.flow.speed_m_s=0.0125"};
  const runs::PlanPlace place{folder.path(), "", ""};
  CHECK(experiments::summarise_tasks(plan, place, physics::RigDescription()).cells == 0);
  finish(plan, place, "pose/planner/bare", {1.0, 2.0});
  finish(plan, place, "still/point/planner/bare", {1.0, 2.0, 3.0});
  finish(plan, place, "flow/point/planner/bare", {2.0, 4.0, 6.0});
  finish(plan, place, "flow/point/baseline/bare", {4.0, 8.0, 12.0});
  finish(plan, place, "still/square/planner/bare", {1.0});
  finish(plan, place, "flow/point/oracle/bare", {1.0, 1.0});
  const runs::TasksSummary summary = experiments::summarise_tasks(plan, place, physics::RigDescription());
  CHECK(summary.cells == 6);
  CHECK(summary.cells_planned == 7);
  CHECK(*summary.flow_speed_m_s == 0.0125);
  CHECK(*summary.square_speed_limit_m_s > 0.006);
  const runs::TaskFigures& flow = summary.groups.at("flow").at("point").at("planner").at("bare");
  CHECK(*flow.ratio_to_still == Approx(2.0));
  CHECK(flow.ratio_to_still_interval->at(0) == Approx(2.0));  // trial by trial twice as much
  CHECK(flow.ratio_to_still_interval->at(1) == Approx(2.0));
  CHECK(*flow.ratio_to_baseline == Approx(0.5));
  CHECK(*flow.ratio_to_oracle == Approx(3.0));  // on the trials that both drove
  CHECK_FALSE(summary.groups.at("flow").at("point").at("oracle").at("bare").ratio_to_oracle);
  CHECK_FALSE(summary.groups.at("flow").at("point").at("baseline").at("bare").ratio_to_still);
  CHECK_FALSE(summary.alone.at("pose").at("planner").at("bare").ratio_to_baseline);
  CHECK(summary.alone.at("pose").at("planner").count("decorated") == 0);
  CHECK(summary.groups.at("square_at_mm_s").at("2").at("planner").at("bare").n_trials == 1);
  const common::Json json = common::artefact_to_json(summary);
  CHECK(json["flow"]["point"]["planner"]["bare"]["ratio_to_still"] == *flow.ratio_to_still);
  CHECK(json["pose"]["planner"]["bare"]["sensed"]["mean_error_mm"] == 1.5);
  CHECK(common::artefact_to_json(common::artefact_from_json<runs::TasksSummary>(json, "summary.json")) ==
        json);
}
