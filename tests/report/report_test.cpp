#include "lodestone/report/report.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/report/error_table.h"
#include "temporary_folder.h"

namespace {

using namespace lodestone::report;
using lodestone::common::Json;

void write(const std::string& path, const std::string& content) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  lodestone::common::write_file_atomically(path, content);
}

Json errors(double mean_mm) {
  return {{"mean_error_mm", mean_mm}, {"std_error_mm", 0.5},   {"median_error_mm", 1.0},
          {"rms_error_mm", 1.625},    {"success_rate", 0.875}, {"n_trials", 8}};
}

void write_deployment(const std::string& folder, const std::string& rig, double mean_mm) {
  write(folder + "/deploy/" + rig + "/summary.json",
        Json{{"centre", errors(mean_mm)}, {"baseline", {{"centre", errors(4.375)}}}}.dump());
  write(folder + "/deploy/" + rig + "/trials.json",
        Json::array({{{"task", "centre"},
                      {"controller", "policy"},
                      {"target_mm", {0.0, 0.0}},
                      {"trajectory", {{20.0, 10.0, 0.1}, {5.0, 2.0, 0.2}, {0.5, 0.1, 0.3}}},
                      {"final_error_mm", 0.5},
                      {"success", true}}})
            .dump());
}

void write_run(const std::string& folder) {
  write(folder + "/collect/config.json", R"({"transitions": 4321})");
  write(folder + "/dynamics/evaluation.json",
        R"({"position_rms_mm": 2.718, "heading_rms_deg": 20.5, "normalised_l2": 0.0625, "n": 400,
            "k_step": {"1": 2.718, "2": 4.5, "5": 9.0, "10": 15.0},
            "baselines": {"no_motion": {"position_rms_mm": 13.5, "heading_rms_deg": 93.0},
                          "knn10": {"position_rms_mm": 4.55, "heading_rms_deg": 32.0}},
            "error_map": [{"x_m": 0.0, "y_m": 0.0, "rms_mm": 2.0, "n": 10}]})");
  write(folder + "/dynamics/metrics.jsonl",
        "{\"step\":1,\"train_loss\":0.5,\"validation_loss\":0.6}\n{\"step\":2,\"train_loss\":0.4,\"valida");
  write(folder + "/policy/result.json", R"({"env_steps": 1000, "updates": 100, "train_seconds": 12.5})");
  write(folder + "/policy/metrics.jsonl",
        "{\"step\":1000,\"evaluation/episode_return\":3.5,\"evaluation/success_rate\":0.5}\n");
  write_deployment(folder, "explored", 1.234);
  write_deployment(folder, "unseen", 2.345);
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
  write(folder / "dynamics/evaluation.json", R"({"position_rms_mm": 2.718, "n": 4})");
  write_report(folder.path(), "", folder / "report.html");
  const std::string page = lodestone::common::read_file(folder / "report.html");
  CHECK(page.find("lodestone collect") != std::string::npos);
  CHECK(page.find("lodestone deploy") != std::string::npos);
  CHECK_THROWS_AS(write_report(folder / "nowhere", "", folder / "x.html"), lodestone::common::ConfigError);
}

TEST_CASE("a damaged file is named") {
  const lodestone::tests::TemporaryFolder folder;
  write(folder / "dynamics/evaluation.json", "{\"position_rms_mm\": ");
  CHECK_THROWS_WITH(read_run(folder.path()), Catch::Contains("evaluation.json"));
}
