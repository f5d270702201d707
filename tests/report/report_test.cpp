#include "lodestone/report/report.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/report/error_table.h"
#include "report/small_run.h"
#include "temporary_folder.h"

namespace {

using namespace lodestone::report;
using lodestone::common::artefact_to_json;
using lodestone::common::Json;
using lodestone::tests::write_with_folders;
namespace runs = lodestone::runs;

runs::TaskSummary errors(double mean_mm) {
  runs::TaskSummary summary;
  summary.n_trials = 8;
  runs::ErrorStatistics& truth = summary.truth.emplace();
  truth.mean_error_mm = mean_mm;
  truth.success_rate = 0.875;
  summary.sensed.mean_error_mm = mean_mm + 0.5;
  return summary;
}

runs::TrialRecord trial(const std::string& controller, bool known) {
  runs::TrialRecord record;
  record.task = "centre";
  record.controller = controller;
  record.target_mm = {0.0, 0.0};
  record.sensed_trajectory = {runs::PoseMm{20.0, 10.0, 0.1}, std::nullopt, runs::PoseMm{1.0, 0.1, 0.3}};
  if (known) record.trajectory = {{20.0, 10.0, 0.1}, {5.0, 2.0, 0.2}, {0.5, 0.1, 0.3}};
  if (known) record.truth.emplace();
  return record;
}

runs::RigSummary rig_summary(double mean_mm, const std::string& controller) {
  runs::RigSummary summary;
  summary.controller = controller;
  summary.tasks.by_task["centre"] = errors(mean_mm);
  summary.baseline.emplace().by_task["centre"] = errors(4.375);
  return summary;
}

/// What deploy leaves behind, on the explored rig and on unseen ones.
void write_deployment(const std::string& folder, const std::string& controller) {
  runs::DeploymentSummary summary;
  static_cast<runs::RigSummary&>(summary) = summary.by_rig["explored"] = rig_summary(1.234, controller);
  summary.by_rig["unseen"] = rig_summary(2.345, controller);
  write_with_folders(folder + "/deploy/summary.json", artefact_to_json(summary).dump());
  for (const char* rig : {"explored", "unseen"})
    write_with_folders(
        folder + "/deploy/" + rig + "/trials.json",
        Json::array({artefact_to_json(trial(controller, true)), artefact_to_json(trial("baseline", true))})
            .dump());
}

runs::DynamicsEvaluation evaluation() {
  runs::DynamicsEvaluation made;
  made.one_step = {2.718, 20.5};
  made.normalised_l2 = 0.0625;
  made.n = 400;
  made.open_loop.k_step_mm = {{1, 2.718}, {2, 4.5}, {5, 9.0}, {10, std::nullopt}};
  made.baselines = runs::DynamicsBaselines{{13.5, 93.0}, {4.55, 32.0}};
  made.error_map = {{0.0, 0.0, 2.0, 10}};
  return made;
}

void write_run(const std::string& folder, const std::string& controller = "policy") {
  write_with_folders(folder + "/collect/config.json", R"({"transitions": 4321})");
  write_with_folders(folder + "/dynamics/evaluation.json", artefact_to_json(evaluation()).dump());
  write_with_folders(
      folder + "/dynamics/metrics.jsonl",
      "{\"step\":1,\"train_loss\":0.5,\"validation_loss\":0.6}\n{\"step\":2,\"train_loss\":0.4,\"valida");
  runs::PolicyResult result;
  result.env_steps = 1000;
  result.updates = 100;
  result.train_seconds = 12.5;
  write_with_folders(folder + "/policy/result.json", artefact_to_json(result).dump());
  write_with_folders(folder + "/policy/metrics.jsonl",
                     "{\"step\":1000,\"evaluation/episode_return\":3.5,\"evaluation/success_rate\":0.5}\n");
  write_deployment(folder, controller);
}

}  // namespace

TEST_CASE("the page shows what the run measured and loads nothing from elsewhere") {
  const lodestone::tests::TemporaryFolder folder;
  write_run(folder.path());
  write_report(folder.path(), "", folder / "report.html");
  const std::string page = lodestone::common::read_file(folder / "report.html");
  for (const char* text : {"2.718", "1.23", "2.35", "6.3", "31.0", "<svg", "<canvas"}) {
    CAPTURE(text);
    CHECK(page.find(text) != std::string::npos);
  }
  const std::regex loads(R"((src|href)\s*=\s*"(https?:)?//)");
  CHECK_FALSE(std::regex_search(page, loads));
  CHECK(page.find("@import") == std::string::npos);
}

TEST_CASE("the summary holds every key that scripts read") {
  const lodestone::tests::TemporaryFolder folder;
  write_run(folder.path());
  write_report(folder.path(), "", folder / "report.html");
  const Json summary = Json::parse(lodestone::common::read_file(folder / "summary.json"));
  CHECK(summary["centre"]["mean_error_mm"] == 1.234);
  CHECK(summary["unseen"]["centre"]["mean_error_mm"] == 2.345);
  CHECK(summary["dynamics"]["position_rms_mm"] == 2.718);
  CHECK(summary["policy"]["updates"] == 100);
  CHECK(summary["policy"]["train_seconds"] == 12.5);
  const std::string table = lodestone::common::read_file(folder / "table.txt");
  CHECK(table.find("1.23") != std::string::npos);
  CHECK(table.find("31.00") != std::string::npos);
}

TEST_CASE("the table sets the paper's figures first, task by task") {
  const lodestone::tests::TemporaryFolder folder;
  write_run(folder.path());
  const std::vector<ErrorRow> rows = error_rows(read_run(folder.path()));
  REQUIRE(rows.size() >= 6);
  CHECK(rows[0].published);
  CHECK(rows[0].mean_mm == 31.0);
  const auto measured = std::find_if(rows.begin(), rows.end(), [](const ErrorRow& row) {
    return row.task == "centre" && row.rig == "explored" && row.controller == "policy";
  });
  REQUIRE(measured != rows.end());
  CHECK(measured->mean_mm == 1.234);
  CHECK(measured->success_rate == 0.875);
}

TEST_CASE("what is missing is said, with the command that makes it") {
  const lodestone::tests::TemporaryFolder folder;
  write_with_folders(folder / "dynamics/evaluation.json", artefact_to_json(evaluation()).dump());
  write_report(folder.path(), "", folder / "report.html");
  const std::string page = lodestone::common::read_file(folder / "report.html");
  CHECK(page.find("lodestone collect") != std::string::npos);
  CHECK(page.find("lodestone deploy") != std::string::npos);
}

TEST_CASE("without a run there is no page, and no folder is made for it") {
  const lodestone::tests::TemporaryFolder folder;
  const auto report_of = [&](const std::string& run) { write_report(run, "", folder / "pages/x.html"); };
  CHECK_THROWS_WITH(report_of(folder / "nowhere"), Catch::Contains("no such folder"));
  CHECK_THROWS_WITH(report_of(folder.path()), Catch::Contains("holds no run"));
  CHECK_FALSE(std::filesystem::exists(folder / "pages"));
  CHECK_FALSE(std::filesystem::exists(folder / "nowhere"));
}

TEST_CASE("a damaged file is named") {
  const lodestone::tests::TemporaryFolder folder;
  write_with_folders(folder / "dynamics/evaluation.json", "{\"position_rms_mm\": ");
  CHECK_THROWS_WITH(read_run(folder.path()), Catch::Contains("evaluation.json"));
}

TEST_CASE("a planner's run is tabled and drawn as the planner's") {
  const lodestone::tests::TemporaryFolder folder;
  write_run(folder.path(), "planner");
  write_report(folder.path(), "", folder / "report.html");
  const std::vector<ErrorRow> rows = error_rows(read_run(folder.path()));
  const auto by = [&](const std::string& controller) {
    return std::count_if(rows.begin(), rows.end(),
                         [&](const ErrorRow& row) { return row.controller == controller; });
  };
  CHECK(by("planner") == 2);
  CHECK(by("policy") == 0);
  const std::string page = lodestone::common::read_file(folder / "report.html");
  CHECK(page.find("Trajectories: centre, planner") != std::string::npos);
  CHECK(page.find("Trajectories: centre, policy") == std::string::npos);
  CHECK(page.find("planner, unseen rigs") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "images/unseen_planner_centre.svg"));
}

TEST_CASE("where nobody knows the true pose, there is none in the table, and what was seen is drawn") {
  const lodestone::tests::TemporaryFolder folder;
  runs::DeploymentSummary summary;
  summary.controller = "policy";
  summary.scored_by = "camera";
  runs::TaskSummary task = errors(1.0);
  task.truth.reset();
  summary.tasks.by_task["centre"] = task;
  write_with_folders(folder / "deploy/summary.json", artefact_to_json(summary).dump());
  write_with_folders(folder / "deploy/trials.json",
                     Json::array({artefact_to_json(trial("policy", false))}).dump());
  write_report(folder.path(), "", folder / "report.html");
  const std::vector<ErrorRow> rows = error_rows(read_run(folder.path()));
  CHECK(rows.back().rig == "real");
  CHECK_FALSE(rows.back().mean_mm);
  CHECK(rows.back().sensed_mean_mm == 1.5);
  CHECK(lodestone::common::read_file(folder / "images/real_policy_centre.svg").find("xmlns") !=
        std::string::npos);
}
