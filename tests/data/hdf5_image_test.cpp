#include "lodestone/data/hdf5_image.h"

#include <catch2/catch.hpp>

#include "fuzz/fuzz.h"
#include "hdf5_handle.h"
#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

std::string sample() {
  data::Hdf5Image image("sample");
  image.add_group("episode_0");
  image.add_group("episode_0/infos");
  image.add_attribute("episode_0", "id", std::int64_t{7});
  image.add_attribute("", "what", std::string("a sample"));
  image.add_array("episode_0/rewards", std::vector<double>{0.25, -1.0}, {2});
  image.add_array("episode_0/observations", std::vector<double>{1, 2, 3, 4, 5, 6}, {3, 2});
  image.add_array("steps", std::vector<std::int64_t>{1, 2}, {2});
  image.add_flags("episode_0/infos/is_success", {0, 1, 1});
  return image.bytes();
}

}  // namespace

TEST_CASE("groups, arrays, flags and attributes are in the file that the bytes make") {
  const tests::TemporaryFolder folder;
  tests::write_bytes(folder / "a.h5", sample());
  const data::Handle file(H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  REQUIRE(file.valid());
  std::string what;
  CHECK((data::read_attribute(file.get(), "what", what) && what == "a sample"));
  const data::Handle group = data::open_group(file.get(), "episode_0");
  std::int64_t id = 0;
  CHECK((data::read_attribute(group.get(), "id", id) && id == 7));

  double rewards[2] = {};
  const data::Handle array(H5Dopen2(group.get(), "rewards", H5P_DEFAULT), H5Dclose);
  CHECK(H5Dread(array.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rewards) >= 0);
  CHECK((rewards[0] == 0.25 && rewards[1] == -1.0));

  const data::Handle table(H5Dopen2(group.get(), "observations", H5P_DEFAULT), H5Dclose);
  const data::Handle space(H5Dget_space(table.get()), H5Sclose);
  hsize_t shape[2] = {};
  CHECK(H5Sget_simple_extent_dims(space.get(), shape, nullptr) == 2);
  CHECK((shape[0] == 3 && shape[1] == 2));

  const data::Handle flags(H5Dopen2(file.get(), "episode_0/infos/is_success", H5P_DEFAULT), H5Dclose);
  const data::Handle type(H5Dget_type(flags.get()), H5Tclose);
  CHECK(H5Tget_class(type.get()) == H5T_ENUM);
  std::int8_t values[3] = {};
  CHECK(H5Dread(flags.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  CHECK((values[0] == 0 && values[1] == 1 && values[2] == 1));
}

TEST_CASE("the same content gives the same bytes") { CHECK(sample() == sample()); }

TEST_CASE("what HDF5 does not take is told with the file's name") {
  data::Hdf5Image image("DIR/main.hdf5");
  image.add_group("a");
  CHECK_THROWS_WITH(image.add_group("a"), Catch::Contains("DIR/main.hdf5"));
  CHECK_THROWS_AS(image.add_array("nowhere/rewards", std::vector<double>{1.0}, {1}), common::IoError);
  CHECK_THROWS_AS(image.add_attribute("nowhere", "id", std::int64_t{1}), common::IoError);
}
