#include "lodestone/experiments/integrity.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "data/synthetic.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/data/journal.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/runs/deployment_results.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

/// A folder with one thing of every kind, whole.
void fill(const std::string& folder) {
  const data::Dataset dataset = tests::random_dataset(3, 4);
  data::write_dataset(folder + "/a.h5", dataset);
  {
    data::JournalWriter journal(folder + "/b.journal", dataset.info, data::AfterDamage::kRefuse);
    journal.write(dataset.episodes[0]);
  }
  inference::Checkpoint checkpoint;
  checkpoint.kind = "policy";
  inference::save_checkpoint(folder + "/checkpoint", checkpoint);
  runs::TrialRecord trial;
  trial.time_s = {0.0, 0.3};
  common::write_file_atomically(folder + "/trials.jsonl",
                                common::artefact_to_json(trial).dump() + "\n{\"task\": \"cut");
  common::write_file_atomically(folder + "/trajectories.csv", "t_s\n0\n0.3\n0.6\n");
  common::write_file_atomically(folder + "/summary.json", "{}\n");
  common::write_file_atomically(folder + "/notes.txt", "mine");
}

std::vector<experiments::CheckedItem> damaged(const std::string& folder) {
  std::vector<experiments::CheckedItem> found;
  for (const auto& item : experiments::check_integrity(folder))
    if (!item.problem.empty()) found.push_back(item);
  return found;
}

void cut(const std::string& path, std::size_t bytes) {
  const std::string content = common::read_file(path);
  common::write_file_atomically(path, content.substr(0, content.size() - bytes));
}

}  // namespace

TEST_CASE("what is whole is said to be, by what it is") {
  const tests::TemporaryFolder folder;
  fill(folder.path());
  const auto items = experiments::check_integrity(folder.path());
  REQUIRE(items.size() == 5);
  CHECK(damaged(folder.path()).empty());
  CHECK(items[0].what == "recording, 12 transitions in 3 episodes");
  CHECK(items[1].what == "unfinished recording, 4 transitions in 1 episode");
  CHECK(items[2].what == "checkpoint, policy");
  CHECK(items[4].what == "deployment, 1 trial that ended");
  CHECK(experiments::check_integrity(folder / "a.h5").size() == 1);
}

TEST_CASE("each thing that is damaged is named, with its reason") {
  const tests::TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> things = {{"a.h5", "damaged"},
                                                                   {"checkpoint/manifest.json", "not JSON"},
                                                                   {"trajectories.csv", "rows are lost"},
                                                                   {"summary.json", "not JSON"}};
  for (const auto& [name, reason] : things) {
    fill(folder.path());
    cut(folder / name, name == "trajectories.csv" ? 8 : 2);
    const auto found = damaged(folder.path());
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0].problem, Contains(reason));
  }
  fill(folder.path());
  cut(folder / "b.journal", 1);  // only what a kill leaves
  CHECK(damaged(folder.path()).empty());
}

TEST_CASE("a folder that holds nothing of ours is no whole one") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "notes.txt", "mine");
  CHECK_THROWS_AS(experiments::check_integrity(folder.path()), common::ConfigError);
  CHECK_THROWS_AS(experiments::check_integrity(folder / "none"), common::ConfigError);
}
