#include "lodestone/exports/minari.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "data/synthetic.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

// What Minari itself reads is compared in minari_reader_test.py.

namespace {

exports::MinariSettings settings(const std::string& id = "lodestone/test-v0") {
  exports::MinariSettings settings;
  settings.id = id;
  settings.task.goal = task::GoalKind::kCentre;
  settings.task.dish_radius_m = 0.0425;
  settings.seed = 5;
  return settings;
}

}  // namespace

TEST_CASE("a dataset of Minari has its files where they are looked for, and says what it holds") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(40, 6);
  const exports::MinariSummary summary = exports::write_minari(folder / "root", dataset, settings());
  CHECK(summary.folder == folder / "root/lodestone/test-v0");
  CHECK(summary.steps == 240);
  CHECK(summary.episodes >= 40);
  const std::string text = common::read_file(summary.folder + "/data/metadata.json");
  const common::Json metadata = common::parse_json(text, "metadata.json");
  CHECK(metadata["total_steps"] == 240);
  CHECK(metadata["total_episodes"] == summary.episodes);
  CHECK(metadata["dataset_id"] == "lodestone/test-v0");
  CHECK(metadata["lodestone"]["task"]["goal"] == "centre");
  CHECK(metadata["lodestone"]["recording"]["action_unit"] == "A");
  const common::Json space = common::parse_json(metadata["observation_space"].get<std::string>(), "space");
  CHECK(space["high"][0] == 0.0425);
  CHECK(space["shape"] == common::Json{3});
  const auto size = std::filesystem::file_size(summary.folder + "/data/main_data.hdf5") + text.size();
  CHECK(summary.bytes == static_cast<std::int64_t>(size));
  CHECK_FALSE(std::filesystem::exists(summary.folder + ".part"));
}

TEST_CASE("the same recording and seed give the same files") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(5, 6);
  for (const char* root : {"a", "b"}) exports::write_minari(folder / root, dataset, settings());
  for (const char* name : {"/lodestone/test-v0/data/main_data.hdf5", "/lodestone/test-v0/data/metadata.json"})
    CHECK(common::read_file(folder / ("a" + std::string(name))) ==
          common::read_file(folder / ("b" + std::string(name))));
}

TEST_CASE("thousands of short episodes take at most five times the room of their numbers") {
  const tests::TemporaryFolder folder;
  const auto summary = exports::write_minari(folder / "root", tests::random_dataset(2700, 13), settings());
  CHECK(summary.steps == 35100);
  CHECK(summary.bytes < 5 * summary.raw_bytes);
}

TEST_CASE("an id that Minari would not take, and a folder that is there, are refused") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(2, 3);
  for (const char* id :
       {"", "name", "name-v", "/name-v0", "a/name-v0", "../name-v0", "na me-v0", "lode//name-v0"})
    CHECK_THROWS_WITH(exports::write_minari(folder / "root", dataset, settings(id)), Contains("no id"));
  CHECK_FALSE(std::filesystem::exists(folder / "root"));
  exports::write_minari(folder / "root", dataset, settings());
  CHECK_THROWS_WITH(exports::write_minari(folder / "root", dataset, settings()), Contains("exists already"));
  CHECK(exports::write_minari(folder / "root", dataset, settings("name-v1")).steps == 6);
  exports::MinariSettings again = settings();
  again.replace = true;
  CHECK(exports::write_minari(folder / "root", tests::random_dataset(3, 3), again).steps == 9);
}

TEST_CASE("a recording is called by its file") {
  CHECK(exports::default_minari_id("runs/rig 1/transitions.h5") == "lodestone/transitions-v0");
  CHECK(exports::default_minari_id("two pulses.csv") == "lodestone/two_pulses-v0");
}
