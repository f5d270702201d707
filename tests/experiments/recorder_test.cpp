#include "lodestone/experiments/recorder.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

experiments::TrialResult trial(bool true_poses) {
  experiments::TrialResult result;
  result.plan.task = "point";
  result.plan.target_m = {0.01, 0.0};
  result.rig = true_poses ? "explored" : "real";
  result.controller = "baseline";
  for (int i = 0; i < 3; ++i) {
    experiments::TrialSample sample;
    sample.step.time_s = 0.3 * i;
    sample.step.target_m = result.plan.target_m;
    sample.step.estimate.valid = i != 1;
    sample.step.estimate.pose = {0.001 * i, 0.0, 0.5};
    sample.step.current_A = {1.0, 0.0, 0.0, 2.0};
    if (true_poses) sample.true_pose = geometry::Pose2{0.002 * i, 0.0, 0.5};
    result.samples.push_back(sample);
  }
  result.sensed.final_error_mm = 8.0;
  if (true_poses) result.truth = result.sensed;
  return result;
}

std::vector<std::string> lines(const std::string& path) {
  std::istringstream text(common::read_file(path));
  std::vector<std::string> all;
  for (std::string line; std::getline(text, line);) all.push_back(line);
  return all;
}

std::int64_t columns(const std::string& line) { return std::count(line.begin(), line.end(), ',') + 1; }

}  // namespace

TEST_CASE("every step is a row, and what was not sensed is empty") {
  const tests::TemporaryFolder folder;
  experiments::Recorder(folder / "t.csv", true).write(trial(true));
  const auto rows = lines(folder / "t.csv");
  REQUIRE(rows.size() == 4);
  for (const std::string& row : rows) CHECK(columns(row) == columns(rows[0]));
  CHECK(rows[0].find("t_s,true_x_m,true_y_m,true_heading_rad,sensed,") != std::string::npos);
  CHECK(rows[2].find("baseline,point,0,0.3,0.002,0,0.5,0,,,,0.01,0,") != std::string::npos);
}

TEST_CASE("rows since the camera has slipped are marked") {
  experiments::TrialResult result = trial(true);
  result.samples[0].step.drive_gain = task::DriveGain{0.25, 0.5};
  result.samples[1].step.estimate.camera_moved = true;
  const tests::TemporaryFolder folder;
  experiments::Recorder(folder / "t.csv", true).write(result);
  const auto rows = lines(folder / "t.csv");
  const auto ends_with = [](const std::string& row, const std::string& end) {
    return row.size() >= end.size() && row.compare(row.size() - end.size(), end.size(), end) == 0;
  };
  CHECK(ends_with(rows[0], ",rig_changed,camera_moved"));
  CHECK(ends_with(rows[1], ",0.25,0.5,0,0"));
  CHECK(ends_with(rows[2], ",,,,1"));
  CHECK(ends_with(rows[3], ",,,,0"));
  CHECK(experiments::record_of(result).camera_moved_s == 0.3);
}

TEST_CASE("the points that a needle was led over are recorded once each, where a way was searched") {
  experiments::TrialResult result = trial(true);
  CHECK_FALSE(experiments::record_of(result).route_mm);
  result.plan.routes = std::make_shared<const task::RouteMap>(task::Region::disc(0.02, 0.004),
                                                              std::vector<task::Move>(), task::RouteConfig());
  result.samples[0].step.target_m = result.samples[1].step.target_m = {0.005, 0.005};
  const auto record = experiments::record_of(result);
  REQUIRE(record.route_mm);
  REQUIRE(record.route_mm->size() == 2);
  CHECK(record.route_mm->front()[1] == Approx(5.0));
  CHECK(record.route_mm->back()[0] == Approx(10.0));
  CHECK(record.target_mm->at(0) == Approx(10.0));
}

TEST_CASE("zones that were told while a needle was driven are recorded with their time") {
  experiments::TrialResult result = trial(true);
  CHECK_FALSE(experiments::record_of(result).told_zones);
  result.told_zones = {{0.0, {}}, {0.3, {{"hand", {0.01, 0.0, 0.02, 0.0}, 0.004}}}};
  const auto record = experiments::record_of(result);
  REQUIRE(record.told_zones);
  REQUIRE(record.told_zones->size() == 2);
  CHECK(record.told_zones->front().zones.empty());
  CHECK(record.told_zones->back().time_s == 0.3);
  const runs::ZoneRecord& zone = record.told_zones->back().zones.at(0);
  CHECK(zone.name == "hand");
  CHECK(zone.radius_mm == Approx(4.0));
  REQUIRE(zone.corners_mm.size() == 2);
  CHECK(zone.corners_mm[1][0] == Approx(20.0));
}

TEST_CASE("how strong the rig was taken to be is recorded where it was identified") {
  experiments::TrialResult result = trial(true);
  CHECK_FALSE(experiments::record_of(result).log_drive_gain);
  result.samples[0].step.drive_gain = task::DriveGain{0.25, 0.5};
  result.samples[2].step.drive_gain = task::DriveGain{0.5, 0.125};
  const auto gain = experiments::record_of(result).log_drive_gain;
  REQUIRE(gain);
  CHECK(gain->at(0) == std::array<double, 2>{0.25, 0.5});
  CHECK_FALSE(gain->at(1));
  CHECK(gain->at(2) == std::array<double, 2>{0.5, 0.125});
  const tests::TemporaryFolder folder;
  experiments::Recorder(folder / "t.csv", true).write(result);
  const auto rows = lines(folder / "t.csv");
  for (const std::string& row : rows) CHECK(columns(row) == columns(rows[0]));
  CHECK(rows[1].find(",2,0.25,0.5") != std::string::npos);
}

TEST_CASE("how the needle should have lain along a path is recorded where that has headings") {
  experiments::TrialResult result = trial(true);
  result.plan.path = geometry::Path({{0.0, 0.0}, {0.01, 0.0}}, false);
  CHECK_FALSE(experiments::record_of(result).reference_heading_rad);
  for (std::size_t i = 0; i < result.samples.size(); ++i)
    result.samples[i].step.target_heading_rad = 0.5 * static_cast<double>(i);
  CHECK(experiments::record_of(result).reference_heading_rad == std::vector<double>{0.0, 0.5, 1.0});
  result.plan.path.reset();
  CHECK_FALSE(experiments::record_of(result).reference_heading_rad);  // a pose has one heading
}

TEST_CASE("where nobody knows the true pose there are no columns for it") {
  const tests::TemporaryFolder folder;
  experiments::Recorder(folder / "t.csv", false).write(trial(false));
  const auto rows = lines(folder / "t.csv");
  CHECK(rows[0].find("true") == std::string::npos);
  for (const std::string& row : rows) CHECK(columns(row) == columns(rows[0]));
  const runs::TrialRecord record = experiments::record_of(trial(false));
  CHECK_FALSE(record.trajectory);
  CHECK_FALSE(record.truth);
  CHECK(record.sensed.final_error_mm == Approx(8.0));
}

TEST_CASE("rows of a real rig's trial that was cut short are set aside, not lost") {
  const tests::TemporaryFolder folder;
  const experiments::TrialResult result = trial(false);
  const auto record = [&](std::int64_t keep_rows, std::size_t samples) {
    experiments::Recorder recorder(folder / "t.csv", false, keep_rows);
    for (std::size_t i = 0; i < samples; ++i)
      recorder.write(result.plan, result.rig, result.controller, result.samples[i]);
  };
  record(0, 2);  // killed in its first trial
  CHECK(lines(folder / "t.csv").size() == 1 + 2);
  record(0, 3);
  record(3, 1);  // killed in its second
  std::ofstream(folder / "t.csv", std::ios::app) << "real,baseline,poi";
  record(3, 3);
  CHECK(lines(folder / "t.csv").size() == 1 + 3 + 3);
  const auto aside = lines(folder / "t_cut_short.csv");
  REQUIRE(aside.size() == 1 + 2 + 1);
  CHECK(aside[0] == lines(folder / "t.csv")[0]);
  CHECK(aside[2] == lines(folder / "t.csv")[2]);
  CHECK_THROWS_WITH(record(100, 0), Catch::Matchers::Contains("fewer rows than the 100"));
}

TEST_CASE("a file of another version's columns is not gone on with") {
  const tests::TemporaryFolder folder;
  std::ofstream(folder / "t.csv") << "rig,controller,task\nunseen,planner,point\n";
  CHECK_THROWS_WITH(experiments::Recorder(folder / "t.csv", true, 1),
                    Catch::Matchers::Contains("t.csv has other columns than this version writes"));
}

TEST_CASE("a file is gone on with after the rows that count") {
  const tests::TemporaryFolder folder;
  experiments::Recorder(folder / "t.csv", true).write(trial(true));
  experiments::Recorder(folder / "t.csv", true, 2).write(trial(true));
  CHECK(lines(folder / "t.csv").size() == 1 + 2 + 3);
}
