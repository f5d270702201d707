#include "episode_groups.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

/// A copy of a recording of version 2, of three episodes.
data::Handle copy_of_version_2(const std::string& path) {
  common::write_file_atomically(path, common::read_file(LODESTONE_SOURCE_DIR "/tests/data/version_2.h5"));
  data::silence_hdf5();
  return {H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose};
}

void remove_attribute(const data::Handle& file, const char* episode, const char* name) {
  REQUIRE(H5Adelete(data::open_group(file.get(), episode).get(), name) >= 0);
}

std::vector<data::Episode> read(const data::Handle& file) {
  data::ArrayReader reader(20'000);
  return data::read_episode_groups(file.get(), 1, data::StateLayout::kPose, reader, "here");
}

}  // namespace

TEST_CASE("a recording of which nobody counted the placements is read") {
  const tests::TemporaryFolder folder;
  const data::Handle file = copy_of_version_2(folder / "a.h5");
  CHECK(read(file)[1].placements == 0);  // it goes on behind a position that cannot be
  remove_attribute(file, "episode_0", "placements");
  CHECK(read(file)[0].placements == 1);
  remove_attribute(file, "episode_1", "placements");
  CHECK_THROWS_WITH(read(file), Contains("here: episode_1: its checksum"));
}

TEST_CASE("episodes without a checksum are read, and a missing one is named") {
  const tests::TemporaryFolder folder;
  const data::Handle file = copy_of_version_2(folder / "a.h5");
  remove_attribute(file, "episode_2", "checksum");
  CHECK(read(file).size() == 3);
  REQUIRE(H5Ldelete(file.get(), "episode_1", H5P_DEFAULT) >= 0);
  CHECK_THROWS_WITH(read(file), Contains("holds 2 groups, but episode_1 is missing"));
}

TEST_CASE("an episode in another file is not read") {
  const tests::TemporaryFolder folder;
  copy_of_version_2(folder / "other.h5");
  const data::Handle file = copy_of_version_2(folder / "a.h5");
  REQUIRE(H5Ldelete(file.get(), "episode_1", H5P_DEFAULT) >= 0);
  REQUIRE(H5Lcreate_external((folder / "other.h5").c_str(), "episode_1", file.get(), "episode_1", H5P_DEFAULT,
                             H5P_DEFAULT) >= 0);
  CHECK_THROWS_WITH(read(file), Contains("episode_1 cannot be opened"));
}

TEST_CASE("many episodes that are links to one cannot ask for more than the file holds") {
  const tests::TemporaryFolder folder;
  const data::Handle file = copy_of_version_2(folder / "a.h5");
  for (int i = 3; i < 5000; ++i)
    REQUIRE(H5Lcreate_hard(file.get(), "episode_0", file.get(), ("episode_" + std::to_string(i)).c_str(),
                           H5P_DEFAULT, H5P_DEFAULT) >= 0);
  CHECK_THROWS_WITH(read(file), Contains("more than the file can hold"));
}
