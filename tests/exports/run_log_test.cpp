#include "lodestone/exports/run_log.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/event_file.h"
#include "exports/mcap_file.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/runs/deployment_results.h"
#include "temporary_folder.h"

using namespace lodestone;
using namespace lodestone::tests;

namespace {

constexpr const char* kHeading =
    "rig,controller,task,trial,t_s,true_x_m,true_y_m,true_heading_rad,sensed,sensed_x_m,sensed_y_m,"
    "sensed_heading_rad,target_x_m,target_y_m,approach,action_x,action_y,current_px_A,current_mx_A,"
    "current_py_A,current_my_A,log_drive_gain,log_drive_gain_sigma,rig_changed\n";

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string row(int trial, double time_s, bool sensed) {
  return "explored,policy,point," + std::to_string(trial) + "," + std::to_string(time_s) +
         ",0.001,0.002,0.5," + (sensed ? "1,0.0011,0.0021,0.51" : "0,,,") +
         ",0.01,0.02,0,0.1,-0.2,1.5,0,0,3,,,\n";
}

/// A trial of two samples, as a run keeps it.
runs::TrialRecord record(std::int64_t trial, bool completed) {
  runs::TrialRecord made;
  made.task = "point";
  made.rig = "explored";
  made.controller = "policy";
  made.trial = trial;
  made.target_mm = runs::PointMm{10.0, 20.0};
  made.time_s = {0.0, 0.3};
  made.sensed_trajectory.resize(2);
  made.temperature_C = {std::nullopt, runs::PerCoil{20.0, 21.0, 22.0, 23.0}};
  made.completed = completed;
  made.stop_reason = completed ? "" : "too warm";
  return made;
}

/// Of the events of a log, what they say.
std::vector<std::string> told(const std::map<std::string, std::vector<std::string>>& messages) {
  std::vector<std::string> texts;
  for (const std::string& event : messages.at("/log")) texts.push_back(Message(event).bytes.at(3));
  return texts;
}

std::uint64_t time_ns(const std::string& message) {
  const Message time(Message(message).bytes.at(1));
  const auto part = [&](int field) { return time.numbers.count(field) == 1 ? time.numbers.at(field) : 0; };
  return part(1) * 1'000'000'000 + part(2);
}

/// Of a foxglove.PoseInFrame.
double heading_rad(const std::string& message) {
  const Message turned(Message(Message(message).bytes.at(3)).bytes.at(2));
  const auto part = [&](int field) {
    double value = 0.0;
    if (turned.bytes.count(field) == 1) std::memcpy(&value, turned.bytes.at(field).data(), sizeof value);
    return value;
  };
  return 2.0 * std::atan2(part(3), part(4));
}

}  // namespace

TEST_CASE("a run's trials become one log, a second between two") {
  const TemporaryFolder run;
  write(run / "trajectories.csv",
        kHeading + row(0, 0.0, true) + row(0, 0.3, false) + row(1, 0.0, true) + row(1, 0.3, true));
  write(run / "trials.json",
        common::Json({common::artefact_to_json(record(0, true)), common::artefact_to_json(record(1, false))})
            .dump());
  const exports::RunLogFacts facts = exports::write_run_log(run.path(), run / "run.mcap");
  CHECK(facts.trials == 2);
  CHECK(facts.steps == 4);
  CHECK(facts.images == 0);
  const auto messages = mcap_messages(run / "run.mcap");
  std::vector<std::uint64_t> times;
  for (const std::string& step : messages.at("/step")) times.push_back(time_ns(step));
  CHECK(times == std::vector<std::uint64_t>{0, 300'000'000, 1'300'000'000, 1'600'000'000});
  CHECK(messages.at("/needle/pose").size() == 3);
  CHECK(messages.at("/needle/truth").size() == 4);
  CHECK(messages.at("/coils/pulse").size() == 4);
  CHECK(messages.at("/coils/status").size() == 2);
  CHECK(told(messages) == std::vector<std::string>{"trial explored-policy-point-0", "no pose: none was found",
                                                   "the trial has ended", "trial explored-policy-point-1",
                                                   "the needle is seen again", "stopped: too warm"});
}

TEST_CASE("a target has the heading that its trial or its path wants at that moment") {
  const TemporaryFolder run;
  write(run / "trajectories.csv", kHeading + row(0, 0.0, true) + row(0, 0.3, true) + row(1, 0.0, true));
  runs::TrialRecord along_path = record(0, true);
  along_path.reference_heading_rad = std::vector<double>{0.25, 0.5};
  runs::TrialRecord pose = record(1, true);
  pose.target_heading_rad = 1.5;
  write(run / "trials.json",
        common::Json({common::artefact_to_json(along_path), common::artefact_to_json(pose)}).dump());
  exports::write_run_log(run.path(), run / "run.mcap");
  const auto targets = mcap_messages(run / "run.mcap").at("/target");
  REQUIRE(targets.size() == 3);
  CHECK(heading_rad(targets[0]) == Approx(0.25));
  CHECK(heading_rad(targets[1]) == Approx(0.5));
  CHECK(heading_rad(targets[2]) == Approx(1.5));
}

TEST_CASE("of a run that was cut off, its journal and the trials that were cut short are in the log") {
  const TemporaryFolder run;
  write(run / "trajectories.csv", kHeading + row(0, 0.0, true) + row(0, 0.3, true) + row(1, 0.0, true));
  write(run / "trajectories_cut_short.csv",
        kHeading + row(1, 0.0, true) + row(1, 0.3, true) + row(1, 0.0, true));
  write(run / "trials.jsonl", common::artefact_to_json(record(0, true)).dump() + "\n{\"task\": \"po");
  CHECK(exports::write_run_log(run.path(), run / "run.mcap").trials == 4);
  const std::string begins = "trial explored-policy-point-1";
  const std::string cut = "the trial was cut short";
  CHECK(told(mcap_messages(run / "run.mcap")) == std::vector<std::string>{"trial explored-policy-point-0",
                                                                          "the trial has ended", begins, cut,
                                                                          begins, cut, begins, cut});
}

TEST_CASE("a run of an older version lacks some columns, and its log what they say") {
  const TemporaryFolder run;
  write(run / "trajectories.csv",
        "rig,controller,task,trial,t_s,sensed_x_m,sensed_y_m,sensed_heading_rad\nreal,policy,point,0,0,0.001,"
        "0.002,0.5\n");
  CHECK(exports::write_run_log(run.path(), run / "run.mcap").steps == 1);
  const auto messages = mcap_messages(run / "run.mcap");
  CHECK(messages.at("/needle/pose").size() == 1);
  for (const char* topic : {"/coils/pulse", "/coils/status", "/target", "/needle/truth"})
    CHECK(messages.count(topic) == 0);
}

TEST_CASE("a folder without trials and a damaged row are refused, and leave no file") {
  const TemporaryFolder run;
  CHECK_THROWS_WITH(exports::write_run_log(run.path(), run / "run.mcap"),
                    Catch::Contains("neither trajectories.csv nor transitions.h5"));
  write(run / "trajectories.csv", kHeading + row(0, 0.0, true) + "explored,policy\n");
  CHECK_THROWS_WITH(exports::write_run_log(run.path(), run / "run.mcap"),
                    Catch::Contains("trajectories.csv:3"));
  CHECK_FALSE(std::filesystem::exists(run / "run.mcap"));
  CHECK_FALSE(std::filesystem::exists(run / "run.mcap.part"));
}
