#include "lodestone/data/dataset_file.h"

#include <hdf5.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/journal.h"
#include "same_episode.h"
#include "synthetic.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

/// A recording whose array `name` is made anew with these properties and dimensions.
void replace_array(const std::string& path, const char* name, hid_t type, std::vector<hsize_t> shape,
                   hid_t creation = H5P_DEFAULT) {
  data::write_dataset(path, tests::random_dataset(2, 3));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  REQUIRE(H5Ldelete(file, name, H5P_DEFAULT) >= 0);
  const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  REQUIRE(dataset >= 0);
  H5Dclose(dataset);
  H5Sclose(space);
  H5Fclose(file);
}

}  // namespace

TEST_CASE("actions of any size come back from the journal and from the file") {
  const tests::TemporaryFolder folder;
  for (const int numbers : {1, 3, 16}) {
    data::Dataset dataset = tests::random_dataset(3, 5);
    dataset.info.action_size = numbers;
    for (data::Episode& episode : dataset.episodes) {
      episode.actions.resize(episode.terminations.size() * static_cast<std::size_t>(numbers));
      for (std::size_t i = 0; i < episode.actions.size(); ++i)
        episode.actions[i] = 0.01 * static_cast<double>(i);
    }
    const std::string path = folder / ("of_" + std::to_string(numbers) + ".h5");
    {
      data::JournalWriter journal(data::journal_beside(path), dataset.info, data::AfterDamage::kRefuse);
      for (const data::Episode& episode : dataset.episodes) journal.write(episode);
    }
    for (int folded = 0; folded < 2; ++folded) {
      const data::Dataset back = data::read_dataset(path);
      CHECK(back.info.action_size == numbers);
      REQUIRE(back.episodes.size() == dataset.episodes.size());
      for (std::size_t e = 0; e < dataset.episodes.size(); ++e)
        CHECK(back.episodes[e].actions == dataset.episodes[e].actions);
      const data::TransitionTable table = data::flatten(back, true);
      CHECK(table.action_size == numbers);
      CHECK(static_cast<std::int64_t>(table.action.size()) == numbers * table.size());
      data::fold_journal(path);
    }
  }
}

TEST_CASE("recordings of other drives do not fit together, nor one whose size is impossible") {
  const tests::TemporaryFolder folder;
  data::write_dataset(folder / "two.h5", tests::random_dataset(2, 3));
  data::Dataset one = tests::random_dataset(2, 3);
  one.info.action_size = 1;
  for (data::Episode& episode : one.episodes) episode.actions.resize(episode.terminations.size());
  data::write_dataset(folder / "one.h5", one);
  CHECK_THROWS_WITH(data::read_recordings(folder / "two.h5," + (folder / "one.h5")), Contains("size"));
  common::Json json = data::info_to_json(one.info);
  json["action_size"] = 17;
  CHECK_THROWS_WITH(data::info_from_json(json, "a.journal"),
                    Contains("action_size is 17, must be within 1 and 16"));
  json.erase("action_size");  // from before there were others
  CHECK(data::info_from_json(json, "a.journal").action_size == 2);
}

TEST_CASE("a dataset comes back from its file bit for bit") {
  const tests::TemporaryFolder folder;
  data::Dataset dataset = tests::random_dataset(12, 7);
  dataset.info.action_unit = "percent";
  dataset.info.action_scale = 100.0;
  dataset.info.workspace_radius_m = 0.0141;
  dataset.info.one_axis_at_a_time = true;
  dataset.info.seed = 42;
  dataset.info.source = "x.csv";
  dataset.info.rig = {{"dish", {{"radius_m", 0.0425}}}};
  dataset.episodes[3].placements = 0;
  dataset.episodes[5].placements = 2;
  CHECK(dataset.placements() == 12);
  data::write_dataset(folder / "a.h5", dataset);
  const data::Dataset back = data::read_any_dataset(folder / "a.h5");
  CHECK(back.info.layout == data::StateLayout::kPose);
  CHECK(back.info.action_unit == "percent");
  CHECK(back.info.action_scale == 100.0);
  CHECK(back.info.workspace_radius_m == 0.0141);
  CHECK(back.info.one_axis_at_a_time);
  CHECK(back.info.control_period_s == dataset.info.control_period_s);
  CHECK(back.info.seed == 42);
  CHECK(back.info.source == "x.csv");
  CHECK(back.info.rig == dataset.info.rig);
  REQUIRE(back.episodes.size() == 12);
  for (std::size_t e = 0; e < 12; ++e) tests::check_equal(back.episodes[e], dataset.episodes[e]);
}

TEST_CASE("the same episodes give the same file") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(3, 4);
  data::write_dataset(folder / "a.h5", dataset);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5's times are in seconds
  data::write_dataset(folder / "b.h5", dataset);
  const auto bytes = [](const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  CHECK(bytes(folder / "a.h5") == bytes(folder / "b.h5"));
}

TEST_CASE("a recording of an earlier version is read as it was") {
  const std::string folder = LODESTONE_SOURCE_DIR "/tests/data/";
  const data::Dataset old = data::read_dataset(folder + "version_2.h5");
  data::CsvImportConfig config;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  const data::Dataset source = data::import_csv(folder + "version_2.csv", config).dataset;
  REQUIRE(old.episodes.size() == 3);
  REQUIRE(old.impossible.size() == 2);
  for (std::size_t e = 0; e < 3; ++e) tests::check_equal(old.episodes[e], source.episodes[e]);
  for (std::size_t e = 0; e < 2; ++e) tests::check_equal(old.impossible[e], source.impossible[e]);

  const tests::TemporaryFolder here;
  data::write_dataset(here / "a.h5", old);
  const data::Dataset back = data::read_dataset(here / "a.h5");
  CHECK(back.info.rig == old.info.rig);
  for (std::size_t e = 0; e < 3; ++e) tests::check_equal(back.episodes[e], old.episodes[e]);
  for (std::size_t e = 0; e < 2; ++e) tests::check_equal(back.impossible[e], old.impossible[e]);
}

TEST_CASE("single pulses take little more room than their numbers") {
  const tests::TemporaryFolder folder;
  data::write_dataset(folder / "a.h5", tests::random_dataset(10'000, 1));
  const std::uintmax_t raw = 10'000 * (2 * 3 * 8 + 2 * 8 + 3);
  CHECK(std::filesystem::file_size(folder / "a.h5") < 2 * raw);
}

TEST_CASE("a number that changed on the disk is noticed, and which episode it is in") {
  const tests::TemporaryFolder folder;
  const std::vector<std::pair<int, std::string>> places = {{7, "'actions'"}, {1500, "episode 1"}};
  for (const auto& [steps, place] : places) {  // in the header of its array, or in a block of its own
    const data::Dataset dataset = tests::random_dataset(3, steps);
    data::write_dataset(folder / "a.h5", dataset);
    std::string bytes = common::read_file(folder / "a.h5");
    const double changed = dataset.episodes[1].actions[5];
    const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&changed), sizeof changed));
    REQUIRE(at != std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    common::write_file_atomically(folder / "a.h5", bytes);
    CHECK_THROWS_WITH(data::read_dataset(folder / "a.h5"), Contains(place) && Contains("damaged"));
  }
}

TEST_CASE("an unfinished recording is read from its journal, and folded into a dataset at its end") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(6, 20);
  const std::string path = folder / "a.h5";
  {
    data::JournalWriter journal(folder / "a.journal", dataset.info, data::AfterDamage::kRefuse);
    for (const data::Episode& episode : dataset.episodes) journal.write(episode);
  }
  CHECK(data::read_dataset(path).episodes.size() == 6);
  CHECK_THROWS_WITH(data::write_dataset(path, dataset), Contains("a.journal") && Contains("unfinished"));
  data::fold_journal(path);
  CHECK_FALSE(std::filesystem::exists(folder / "a.journal"));
  data::write_dataset(folder / "b.h5", dataset);
  CHECK(common::read_file(path) == common::read_file(folder / "b.h5"));
  data::fold_journal(path);  // again: nothing

  data::unfold_dataset(path);
  CHECK(data::read_journal(folder / "a.journal").episodes.size() == 6);
}

TEST_CASE("a whole dataset is written in one piece or not at all") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  data::Dataset dataset = tests::random_dataset(30, 3);
  data::write_dataset(path, dataset);
  CHECK(data::read_dataset(path).transitions() == 90);
  dataset.episodes[20].actions[0] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(data::write_dataset(path, dataset), common::DataError);
  CHECK(data::read_dataset(path).transitions() == 90);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("NaN is neither written nor read") {
  const tests::TemporaryFolder folder;
  data::Dataset dataset = tests::random_dataset(2, 3);
  dataset.episodes[1].observations[4] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(data::write_dataset(folder / "a.h5", dataset), Contains("row 1") && Contains("y_m"));
}

TEST_CASE("files that are no dataset are refused by name") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(data::read_dataset(folder / "none.h5"), Contains("none.h5") && Contains("no such file"));
  std::ofstream(folder / "text.h5") << "hello";
  CHECK_THROWS_WITH(data::read_dataset(folder / "text.h5"),
                    Contains("text.h5") && Contains("not an HDF5 file"));
  CHECK_THROWS_AS(data::write_dataset(folder / "no/such/folder.h5", tests::random_dataset(1, 2)),
                  common::IoError);

  data::write_dataset(folder / "short.h5", tests::random_dataset(20, 200));
  std::filesystem::resize_file(folder / "short.h5", std::filesystem::file_size(folder / "short.h5") / 2);
  CHECK_THROWS_AS(data::read_dataset(folder / "short.h5"), common::DataError);
}

TEST_CASE("several recordings of one rig are read as one") {
  const tests::TemporaryFolder folder;
  const data::Dataset one = tests::random_dataset(3, 5, 1);
  data::Dataset two = tests::random_dataset(2, 4, 2);
  data::write_dataset(folder / "one.h5", one);
  data::write_dataset(folder / "two.h5", two);
  const data::Dataset both = data::read_recordings(folder / "one.h5" + "," + (folder / "two.h5"));
  REQUIRE(both.episodes.size() == 5);
  tests::check_equal(both.episodes[0], one.episodes[0]);
  tests::check_equal(both.episodes[4], two.episodes[1]);
  two.info.action_scale = 3.0;
  data::write_dataset(folder / "three.h5", two);
  CHECK_THROWS_WITH(data::read_recordings(folder / "one.h5" + "," + (folder / "three.h5")),
                    Contains("three.h5"));
}

TEST_CASE("a shape that asks for more than the file holds is refused before memory is taken") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  // Contiguous and never written, such an array takes no room in the file.
  for (const hsize_t rows : {hsize_t{350'000'000}, hsize_t{1} << 50}) {
    replace_array(path, "observations", H5T_IEEE_F64LE, {rows, 3});
    CHECK_THROWS_WITH(data::read_dataset(path), Contains("a.h5: dataset 'observations'"));
  }
  replace_array(path, "observations", H5T_IEEE_F64LE, {4, 0});
  CHECK_THROWS_WITH(data::read_dataset(path), Contains("another shape"));
  replace_array(path, "observations", H5T_C_S1, {4, 3});
  CHECK_THROWS_WITH(data::read_dataset(path), Contains("cannot be read"));
}

TEST_CASE("an array that lies in another file is not read") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  const hid_t outside = H5Pcreate(H5P_DATASET_CREATE);
  REQUIRE(H5Pset_external(outside, "/dev/zero", 0, H5F_UNLIMITED) >= 0);
  replace_array(path, "observations", H5T_IEEE_F64LE, {4, 3}, outside);
  H5Pclose(outside);
  CHECK_THROWS_WITH(data::read_dataset(path), Contains("other files"));

  data::write_dataset(folder / "other.h5", tests::random_dataset(2, 3));
  data::write_dataset(path, tests::random_dataset(2, 3));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  REQUIRE(H5Ldelete(file, "actions", H5P_DEFAULT) >= 0);
  REQUIRE(H5Lcreate_external((folder / "other.h5").c_str(), "actions", file, "actions", H5P_DEFAULT,
                             H5P_DEFAULT) >= 0);
  H5Fclose(file);
  CHECK_THROWS_WITH(data::read_dataset(path), Contains("'actions' is missing"));
}

TEST_CASE("a pipe and a device are no dataset") {
  const tests::TemporaryFolder folder;
  REQUIRE(::mkfifo((folder / "pipe.h5").c_str(), 0600) == 0);
  CHECK_THROWS_WITH(data::read_dataset(folder / "pipe.h5"), Contains("not a file"));
  CHECK_THROWS_WITH(data::read_dataset("/dev/zero"), Contains("not a file"));
}
