#include "lodestone/exports/recording_log.h"

#include <catch2/catch.hpp>

#include "common/event_file.h"
#include "exports/mcap_file.h"
#include "temporary_folder.h"

using namespace lodestone;
using namespace lodestone::tests;

namespace {

data::Episode episode_of(std::int64_t length, std::int64_t placements) {
  data::Episode episode;
  episode.placements = placements;
  for (std::int64_t row = 0; row <= length; ++row)
    episode.observations.insert(episode.observations.end(), {1e-3 * static_cast<double>(row), 0.002, 0.5});
  for (std::int64_t row = 0; row < length; ++row) episode.actions.insert(episode.actions.end(), {3.0, -6.0});
  episode.terminations.assign(static_cast<std::size_t>(length), 0);
  episode.truncations = episode.zero_current = episode.terminations;
  return episode;
}

}  // namespace

TEST_CASE("a recording becomes a log, its episodes a second apart, with the currents of each pulse") {
  const TemporaryFolder folder;
  data::Dataset dataset;
  dataset.info.action_scale = 15.0;
  dataset.info.control_period_s = 0.3;
  dataset.episodes = {episode_of(2, 1), episode_of(1, 0)};
  exports::RigLog log(folder / "run.mcap", {});
  CHECK(exports::log_recording(dataset, log) == 5);
  log.finish();
  const auto messages = mcap_messages(folder / "run.mcap");
  CHECK(messages.at("/needle/pose").size() == 5);
  REQUIRE(messages.at("/coils/pulse").size() == 3);  // none after the last observation of an episode
  std::vector<std::string> told;
  for (const std::string& event : messages.at("/log")) told.push_back(Message(event).bytes.at(3));
  CHECK(told == std::vector<std::string>{"episode 0, placed by the operator", "episode 1"});
  const Message last(messages.at("/step").back());
  const Message time(last.bytes.at(1));
  CHECK(time.numbers.at(1) == 1);  // 0.6 s, a second, 0.3 s
  CHECK(time.numbers.at(2) == 900'000'000);
}

TEST_CASE("drives in per cent are no currents") {
  const TemporaryFolder folder;
  data::Dataset dataset;
  dataset.info.action_unit = "percent";
  dataset.info.action_scale = 100.0;
  dataset.episodes = {episode_of(2, 1)};
  exports::RigLog log(folder / "run.mcap", {});
  exports::log_recording(dataset, log);
  log.finish();
  const auto messages = mcap_messages(folder / "run.mcap");
  CHECK(messages.count("/coils/pulse") == 0);
  CHECK(messages.at("/step").size() == 3);
}
