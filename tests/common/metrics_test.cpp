#include "lodestone/common/metrics.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/event_file.h"
#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone::common;
using lodestone::tests::event_records;
using lodestone::tests::Message;

TEST_CASE("metrics are one flushed JSON object a line, and appending goes on") {
  const lodestone::tests::TemporaryFolder folder;
  for (int run = 0; run < 2; ++run) {
    MetricsLog log(folder.path());
    log.write(run, {{"train/loss", 0.5 + run}});
  }
  std::istringstream lines(read_file(folder / "metrics.jsonl"));
  std::string line;
  for (int run = 0; run < 2; ++run) {
    REQUIRE(std::getline(lines, line));
    const Json json = Json::parse(line);
    CHECK(json["step"] == run);
    CHECK(json["train/loss"] == 0.5 + run);
  }
}

TEST_CASE("going on from a step drops what was logged beyond it, here and in TensorBoard") {
  const lodestone::tests::TemporaryFolder folder;
  {
    MetricsLog log(folder.path());
    for (int step = 0; step < 4; ++step) log.write(step, {{"loss", 1.0}});
  }
  std::ofstream(folder / "metrics.jsonl", std::ios::app) << "{\"step\": 4, \"lo";  // cut off by a kill
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (entry.path().extension() == ".lodestone") std::filesystem::remove(entry);
  {
    MetricsLog log(folder.path(), 1, 100.0);
    log.write(2, {{"loss", 2.0}});
  }
  std::istringstream lines(read_file(folder / "metrics.jsonl"));
  std::vector<double> losses;
  double wall_s = 0.0;
  for (std::string line; std::getline(lines, line);) {
    losses.push_back(Json::parse(line).at("loss").get<double>());
    wall_s = Json::parse(line).at("wall_s").get<double>();
  }
  CHECK(losses == std::vector<double>{1.0, 1.0, 2.0});
  CHECK(wall_s >= 100.0);
  const Message start(event_records(folder.path()).at(1));
  CHECK(start.numbers.at(2) == 2);
  CHECK(Message(start.bytes.at(7)).numbers.at(1) == 1);
}

TEST_CASE("TensorBoard is told how a run is configured, before its first curve, and what it came to") {
  const lodestone::tests::TemporaryFolder folder;
  {
    MetricsLog log(folder.path(), kNoStep, 0.0, {{"model", {{"rate", 0.5}}}});
    log.write(1, {{"loss", 1.5}});
  }
  const std::vector<std::string> before = event_records(folder.path());
  REQUIRE(before.size() == 5);  // the version, the start, the configuration twice, the curve
  CHECK(before[2].find("\"rate\": 0.5") != std::string::npos);
  CHECK(before[3].find("model.rate") != std::string::npos);
  MetricsLog(folder.path()).write_result(9, {{"kind", "test"}, {"one_step", {{"rms_mm", 0.25}}}});
  std::string all;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (entry.path().extension() == ".lodestone") all += read_file(entry.path().string());
  CHECK(all.find("final/one_step.rms_mm") != std::string::npos);
  CHECK(all.find("final/kind") == std::string::npos);
  CHECK(all.find("_hparams_/session_end_info") != std::string::npos);
}
