#include "lodestone/experiments/task_file.h"

#include <catch2/catch.hpp>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/experiments/deployment_job.h"
#include "temporary_folder.h"

using namespace lodestone;
using experiments::settings_of_task;

namespace {

/// What a task's file makes of a deployment's configuration.
experiments::DeployConfig described(const std::string& file, const std::string& text) {
  common::write_file_atomically(file, text);
  common::Json json = common::Json::object();
  for (const std::string& setting : settings_of_task(file)) common::apply_override(json, setting);
  return common::config_from_json<experiments::DeployConfig>(json, "test");
}

}  // namespace

TEST_CASE("a file that describes a task is told from a task by its ending") {
  CHECK(experiments::is_task_file("tasks/way.json"));
  for (const char* task : {"square", "way.csv", "json", ""}) CHECK_FALSE(experiments::is_task_file(task));
}

TEST_CASE("a task's file sets what the options would") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "task.json";
  auto config = described(file, R"({"task": "path", "path": "way.csv", "heading": "column", "laps": 2})");
  CHECK(config.task == folder / "way.csv");  // beside it
  CHECK(config.deployment.trials.path_heading == geometry::HeadingRule::kColumn);
  CHECK(config.deployment.reference.laps == 2);
  config = described(file, R"({"task": "square", "side_m": 0.02, "speed_m_s": 0.001, "heading": "tangent"})");
  CHECK(config.task == "square");
  CHECK(config.deployment.trials.square_side_m == 0.02);
  CHECK(config.deployment.reference.speed_m_s == 0.001);
  CHECK(config.deployment.trials.path_heading == geometry::HeadingRule::kTangent);
  config = described(
      file, R"({"task": "pose", "target_mm": [5, -3], "heading": 90, "seconds": 10, "flow": "pulsing"})");
  CHECK(config.target_mm == std::vector<double>{5.0, -3.0});
  CHECK(config.deployment.trials.path_heading == geometry::HeadingRule::kFixed);
  CHECK(config.deployment.trials.path_heading_deg == 90.0);
  CHECK(config.deployment.trials.point_seconds == 10.0);
  CHECK(config.flow == experiments::TrialFlow::kPulsing);
  config = described(file, R"({"task": "circle", "radius_m": 0.01})");
  CHECK(config.deployment.trials.circle_radius_m == 0.01);
  CHECK(config.deployment.trials.path_heading == geometry::HeadingRule::kNone);
}

TEST_CASE("what is wrong in a task's file is said in a line that names it") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "task.json";
  const char* const bad[][2] = {
      {"[1]", "a task is a JSON object"},
      {"{", "task.json:1:"},
      {"{}", "task is missing: one of centre, point"},
      {R"({"task": "triangle"})", "task = \"triangle\" must be one of centre, point"},
      {R"({"task": 3})", "task = 3 must be one of"},
      {R"({"task": "square", "headin": 3})", "unknown key headin = 3; did you mean heading?"},
      {R"({"task": "path"})", "path is missing"},
      {R"({"task": "path", "path": "way.txt"})", "path = \"way.txt\" must be the name of a .csv file"},
      {R"({"task": "path", "path": 7})", "path = 7 must be the name of a .csv file"},
      {R"({"task": "point", "path": "way.csv"})",
       "path = \"way.csv\" belongs to path, not to the task \"point\""},
      {R"({"task": "point", "stitches": 5})", "stitches = 5 belongs to suture, not to the task \"point\""},
      {R"({"task": "point", "side_m": 0.02})", "side_m = 0.02 belongs to square, not to the task \"point\""},
      {R"({"task": "square", "seconds": 5})",
       "seconds = 5 belongs to centre, point, pose, not to the task \"square\""},
      {R"({"task": "suture", "laps": 2})", "laps = 2 belongs to square, circle, path, not to"},
      {R"({"task": "suture", "heading": 90})", "heading = 90 is not for the task \"suture\""},
      {R"({"task": "suture", "stitches": "five"})", "stitches = \"five\" must be how many"},
      {R"({"task": "suture", "stitches": []})", "stitches = [] must be how many"}};
  for (const auto& [content, message] : bad) {
    CAPTURE(content);
    common::write_file_atomically(file, content);
    CHECK_THROWS_WITH(settings_of_task(file), Catch::Contains("task.json") && Catch::Contains(message));
    CHECK_THROWS_AS(settings_of_task(file), common::ConfigError);
  }
  CHECK_THROWS_AS(settings_of_task(folder / "missing.json"), common::ConfigError);
  CHECK_THROWS_AS(described(file, R"({"task": "square", "heading": "sideways"})"), common::ConfigError);
  CHECK_THROWS_AS(described(file, R"({"task": "square", "side_m": "long"})"), common::ConfigError);
}

TEST_CASE("a suture is described by its stitches, one by one or in a row") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "task.json";
  auto config = described(file, R"({"task": "suture", "speed_m_s": 0.001, "stitches": [
      {"entry_mm": [-8, -3], "entry_deg": 90, "exit_mm": [-7, 3], "exit_deg": 80},
      {"entry_mm": [-4, 3], "entry_deg": -90, "exit_mm": [-4, -3], "exit_deg": -90}]})");
  CHECK(config.task == "suture");
  CHECK(config.deployment.suture.speed_m_s == 0.001);
  CHECK(config.deployment.reference.speed_m_s == control::PathReferenceConfig().speed_m_s);
  REQUIRE(config.deployment.trials.suture.stitches.size() == 2);
  CHECK(config.deployment.trials.suture.stitches[0].exit_mm == std::vector<double>{-7.0, 3.0});
  CHECK(config.deployment.trials.suture.stitches[1].entry_deg == -90.0);
  config = described(file, R"({"task": "suture", "stitches": 3, "length_m": 0.008, "pitch_m": 0.005})");
  CHECK(config.deployment.trials.suture.stitches.empty());
  CHECK(config.deployment.trials.suture.count == 3);
  CHECK(config.deployment.trials.suture.length_m == 0.008);
  CHECK(config.deployment.trials.suture.pitch_m == 0.005);
  CHECK(described(file, R"({"task": "suture"})").deployment.trials.suture.count == 5);
  CHECK_THROWS_WITH(described(file, R"({"task": "suture", "stitches": [{"entry_mm": [1, 2]}]})"),
                    Catch::Contains("trials.suture.stitches[0].exit_mm = [] must hold two numbers"));
  CHECK_THROWS_WITH(described(file, R"({"task": "suture", "stitches": [3]})"),
                    Catch::Contains("trials.suture.stitches[0] = 3 must be a JSON object"));
  CHECK_THROWS_WITH(described(file, R"({"task": "suture", "stitches": 2.5})"),
                    Catch::Contains("trials.suture.count = 2.5 must be a whole number"));
}
