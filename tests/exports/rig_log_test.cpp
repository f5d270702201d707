#include "lodestone/exports/rig_log.h"

#include <catch2/catch.hpp>

#include "common/event_file.h"
#include "exports/mcap_file.h"
#include "temporary_folder.h"

using namespace lodestone;
using namespace lodestone::tests;

TEST_CASE("a step is told on the topics of what is known of it") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  exports::RigLog log(path, {{"verb", "deploy"}});
  exports::LoggedStep step;
  step.target = geometry::Pose2{0.01, 0.0, 0.0};
  step.facts.reason = "nothing is seen";
  log.step(step);
  step.time_ns = 300'000'000;
  step.sensed = geometry::Pose2{};
  step.truth = geometry::Pose2{};
  step.current_A = exports::OfCoils(4);
  step.reading.emplace();
  log.step(step);
  log.image(600'000'000, 590'000'000, "jpeg");
  log.event(600'000'000, exports::LogLevel::kWarning, "far");
  log.finish();
  const auto messages = mcap_messages(path);
  CHECK(messages.at("/step").size() == 2);
  CHECK(messages.at("/target").size() == 2);
  CHECK(messages.at("/tf").size() == 1);
  for (const char* topic : {"/needle/pose", "/needle/truth", "/coils/pulse", "/coils/status"})
    CHECK(messages.at(topic).size() == 1);
  CHECK(Message(messages.at("/camera/image").at(0)).bytes.at(2) == "jpeg");
  CHECK(Message(Message(messages.at("/camera/image").at(0)).bytes.at(1)).numbers.at(2) == 590'000'000);
  CHECK(Message(messages.at("/log").back()).bytes.at(3) == "far");
}

TEST_CASE("what changes from step to step is told once, as an event") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  exports::RigLog log(path, {});
  exports::LoggedStep step;
  const auto next = [&](bool sensed, const std::vector<std::string>& faults, bool rig_changed) {
    step.time_ns += 300'000'000;
    step.facts.sensed = sensed;
    step.facts.reason = sensed ? "" : "nothing is seen";
    step.facts.rig_changed = rig_changed;
    step.reading.emplace().faults = faults;
    for (int again = 0; again < 2; ++again) log.step(step);
  };
  next(true, {}, false);
  next(false, {}, false);
  next(true, {"over-temperature", "stuck driver"}, false);
  step.reading.reset();
  log.step(step);  // nothing is reported, and so nothing new
  next(true, {}, true);
  next(true, {}, false);
  log.finish();
  std::vector<std::pair<std::uint64_t, std::string>> told;
  const auto messages = mcap_messages(path);
  for (const std::string& event : messages.at("/log"))
    told.emplace_back(Message(event).numbers.at(2), Message(event).bytes.at(3));
  CHECK(told == std::vector<std::pair<std::uint64_t, std::string>>{
                    {3, "no pose: nothing is seen"},
                    {2, "the needle is seen again"},
                    {4, "the coils report: over-temperature, stuck driver"},
                    {3, "the needle no longer moves as the simulator expects of any strength of the rig"},
                    {2, "the coils report no fault any more"}});
}

TEST_CASE("the frame is told again every ten seconds") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  exports::RigLog log(path, {});
  for (std::uint64_t second = 0; second < 25; ++second) {
    exports::LoggedStep step;
    step.time_ns = second * 1'000'000'000;
    log.step(step);
  }
  log.finish();
  CHECK(mcap_messages(path).at("/tf").size() == 3);
}

TEST_CASE("a log has the facts it was given") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  exports::RigLog(path, {{"config", "{}"}, {"verb", "deploy"}}).finish();
  for (const McapRecord& record : mcap_file_records(path)) {
    if (record.opcode != 12) continue;
    Bytes fields(record.content);
    CHECK(fields.counted() == "lodestone");
    Bytes pairs(fields.counted());
    CHECK(pairs.counted() == "config");
    CHECK(pairs.counted() == "{}");
    return;
  }
  FAIL("no metadata");
}
