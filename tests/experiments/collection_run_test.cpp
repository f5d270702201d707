#include "lodestone/experiments/collection_run.h"

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

experiments::CollectionConfig small() {
  experiments::CollectionConfig config;
  config.sensor.kind = "simulated";
  config.transitions = 90;
  config.episode_steps = 6;
  config.sessions = 2;
  return config;
}

experiments::Sessions sessions_of(const experiments::CollectionConfig& config) {
  experiments::Sessions sessions;
  for (std::int64_t i = 0; i < config.sessions; ++i)
    sessions.push_back(std::make_unique<experiments::Collection>(config, i));
  return sessions;
}

/// Goes on for so many rounds, or to the end.
void record(const std::string& folder, std::int64_t threads, bool going_on, bool save, int rounds = 1000) {
  common::make_folders(folder);
  const auto config = small();
  const auto sessions = sessions_of(config);
  experiments::CollectionRun work(config, sessions, true, threads, folder);
  if (going_on) work.load(folder);
  common::MetricsLog metrics(folder);
  for (int i = 0; i < rounds && !work.progress().finished; ++i) {
    work.step(metrics);
    if (save) work.save(folder);
  }
}

void check_same_run(const std::string& a, const std::string& b) {
  const data::Dataset one = data::read_dataset(a + "/transitions.h5");
  const data::Dataset two = data::read_dataset(b + "/transitions.h5");
  REQUIRE(one.episodes.size() == two.episodes.size());
  for (std::size_t i = 0; i < one.episodes.size(); ++i) {
    CHECK(one.episodes[i].observations == two.episodes[i].observations);
    CHECK(one.episodes[i].actions == two.episodes[i].actions);
  }
}

}  // namespace

TEST_CASE(
    "a recording goes on as if never stopped, also with episodes in the file that the state does not know") {
  const tests::TemporaryFolder folder;
  record(folder / "whole", 1, false, false);
  CHECK(data::read_dataset(folder / "whole/transitions.h5").transitions() == 90);
  record(folder / "saved", 2, false, true, 1);
  record(folder / "saved", 1, true, true);
  check_same_run(folder / "whole", folder / "saved");
  record(folder / "behind", 2, false, true, 1);
  record(folder / "behind", 2, true, false, 1);  // killed before its next checkpoint
  record(folder / "behind", 2, true, true);
  check_same_run(folder / "whole", folder / "behind");
}
