#include "lodestone/experiments/trial_recording.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "common/event_file.h"
#include "exports/mcap_file.h"
#include "lodestone/experiments/deployment.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::TemporaryFolder;

namespace {

experiments::DeploymentConfig quick_point() {
  experiments::DeploymentConfig config;
  config.sensor.kind = "simulated";
  config.trials.point_seconds = 1.5;
  return config;
}

/// Trials of a point with logs in a folder.
std::vector<experiments::TrialResult> drive(const experiments::DeploymentConfig& config,
                                            const std::string& folder, std::size_t threads) {
  const experiments::Deployment deployment(config);
  common::ThreadPool pool(threads);
  std::vector<experiments::TrialPlan> plans;
  for (std::int64_t index = 0; index < 3; ++index)
    plans.push_back(
        experiments::plan_trial(config, "point", index, std::nullopt, std::nullopt,
                                [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
  experiments::TrialFolders folders;
  common::make_folders(folders.logs = folder);
  return deployment.run(plans, experiments::RigKind::kExplored, experiments::baseline_source(config), pool,
                        false, folders);
}

}  // namespace

TEST_CASE("every trial has a log of its own, which does not depend on threads") {
  const TemporaryFolder folder;
  const auto results = drive(quick_point(), folder / "one", 1);
  drive(quick_point(), folder / "three", 3);
  for (const auto& result : results) {
    const std::string name = "/explored-baseline-point-" + std::to_string(result.plan.index) + ".mcap";
    CHECK(common::read_file(folder / ("one" + name)) == common::read_file(folder / ("three" + name)));
    const auto messages = tests::mcap_messages(folder / ("one" + name));
    for (const char* topic : {"/step", "/needle/truth", "/target"})
      CHECK(messages.at(topic).size() == result.samples.size());
    CHECK(messages.at("/coils/pulse").size() == result.samples.size() - 1);
    REQUIRE(messages.at("/log").size() == 2);
    CHECK(tests::Message(messages.at("/log").back()).bytes.at(3) == "the trial has ended");
  }
}

TEST_CASE("why a trial was stopped is in its log") {
  const TemporaryFolder folder;
  auto config = quick_point();
  config.safety.max_duty = 0.01;
  const auto results = drive(config, folder / "logs", 1);
  REQUIRE_FALSE(results[0].completed);
  const auto messages = tests::mcap_messages(folder / "logs/explored-baseline-point-0.mcap");
  CHECK(tests::Message(messages.at("/log").back()).bytes.at(3) == "stopped: " + results[0].stop_reason);
  CHECK(tests::Message(messages.at("/log").back()).numbers.at(2) == 4);
}

TEST_CASE(
    "a trial that is driven again takes the place of its log on a virtual rig, and none on a real one") {
  const TemporaryFolder folder;
  const auto config = quick_point();
  const auto session = session::make_virtual_session(config.rig, config.sensor, config.safety, {});
  experiments::TrialPlan plan;
  experiments::TrialFolders folders;
  folders.logs = folder.path();
  for (const bool repeatable : {false, false, true, true})
    experiments::TrialRecording(folders, config.record,
                                {repeatable ? "virtual" : "real",
                                 plan,
                                 {session->clock(), session->coils(), nullptr},
                                 config.rig,
                                 0.3,
                                 15.0,
                                 repeatable})
        .finish({});
  std::vector<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(folder.path()))
    files.push_back(file.path().filename());
  std::sort(files.begin(), files.end());
  CHECK(files == std::vector<std::string>{"real-2.mcap", "real.mcap", "virtual.mcap"});
}

TEST_CASE("a disk that is full ends the trial with a word") {
  const TemporaryFolder folder;
  common::make_folders(folder / "logs");
  std::filesystem::create_symlink("/dev/full", folder / "logs/explored-baseline-point-0.mcap");
  CHECK_THROWS_WITH(drive(quick_point(), folder / "logs", 1), Catch::Contains("No space left on device"));
}
