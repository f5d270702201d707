#include <hdf5.h>

#include "data/synthetic.h"
#include "fuzz.h"
#include "lodestone/data/dataset_file.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// A type, and bytes to write as it.
struct OddType {
  explicit OddType(tests::Spoiler& spoiler) : noise(64 * 1024) {
    const std::vector<hid_t> types = {H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_INT8,
                                      H5T_STD_U64BE,     H5T_C_S1,         H5T_NATIVE_LDOUBLE};
    id = H5Tcopy(spoiler.one_of(types));
    if (H5Tget_class(id) == H5T_STRING) H5Tset_size(id, spoiler.below(2) == 0 ? 7 : 50);
    for (std::size_t i = 0; i < 64; ++i) noise[spoiler.below(200)] = static_cast<char>(spoiler.below(256));
  }
  ~OddType() { H5Tclose(id); }
  OddType(const OddType&) = delete;
  OddType& operator=(const OddType&) = delete;

  hid_t id;
  std::vector<char> noise;
};

/// Puts an array of a random type, shape, layout and content into the place of one of the recording: what a
/// checksum of HDF5's own would never let through.
void replace_array(hid_t file, tests::Spoiler& spoiler) {
  const std::vector<const char*> grouped = {"episode_0/observations", "episode_0/actions",
                                            "episode_1/terminations", "episode_1/infos/zero_current"};
  const std::vector<const char*> joined = {"observations", "actions",    "zero_current",
                                           "steps",        "placements", "checksums"};
  const auto& names = H5Lexists(file, "episode_0", H5P_DEFAULT) > 0 ? grouped : joined;
  const std::vector<hsize_t> lengths = {0, 1, 2, 2, 3, 3, 4, 4, 5, 300, 4'000'000'000};
  const hsize_t shape[3] = {spoiler.one_of(lengths), spoiler.one_of(lengths), 1};
  const bool small = shape[0] <= 300 && shape[1] <= 300;
  const hid_t space = spoiler.below(8) == 0
                          ? H5Screate(H5S_NULL)
                          : H5Screate_simple(static_cast<int>(spoiler.below(4)), shape, nullptr);
  const OddType type(spoiler);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t chunk[3] = {1 + spoiler.below(300), 1 + spoiler.below(3), 1};
  if (small && spoiler.below(3) == 0) H5Pset_chunk(creation, 1 + static_cast<int>(spoiler.below(2)), chunk);
  const char* name = spoiler.one_of(names);
  H5Ldelete(file, name, H5P_DEFAULT);
  const hid_t dataset = H5Dcreate2(file, name, type.id, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  if (dataset >= 0 && small && H5Sget_simple_extent_npoints(space) <= 1000)
    H5Dwrite(dataset, type.id, H5S_ALL, H5S_ALL, H5P_DEFAULT, type.noise.data());
  if (dataset >= 0) H5Dclose(dataset);
  H5Pclose(creation);
  H5Sclose(space);
}

/// The same with an attribute of the root.
void replace_attribute(hid_t file, tests::Spoiler& spoiler) {
  const std::vector<const char*> names = {"format",           "layout",      "action_unit",
                                          "action_scale",     "action_size", "format_version",
                                          "control_period_s", "rig",         "workspace_radius_m"};
  const hsize_t length = spoiler.below(300);
  const hid_t space = H5Screate_simple(static_cast<int>(spoiler.below(2)), &length, nullptr);
  const OddType type(spoiler);
  const char* name = spoiler.one_of(names);
  H5Adelete(file, name);
  const hid_t attribute = H5Acreate2(file, name, type.id, space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute >= 0) H5Awrite(attribute, type.id, type.noise.data());
  if (attribute >= 0) H5Aclose(attribute);
  H5Sclose(space);
}

void replace_something(const std::string& path, tests::Spoiler& spoiler) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const std::size_t what = spoiler.below(9);  // one in nine is left as it is
  if (what > 4) replace_array(file, spoiler);
  if (what > 0 && what <= 4) replace_attribute(file, spoiler);
  H5Fclose(file);
}

herr_t copy_attribute(hid_t from, const char* name, const H5A_info_t*, void* to) {
  const hid_t attribute = H5Aopen(from, name, H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  const hid_t space = H5Aget_space(attribute);
  std::vector<char> value(H5Tget_size(type));
  H5Aread(attribute, type, value.data());
  const hid_t copy = H5Acreate2(*static_cast<hid_t*>(to), name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(copy, type, value.data());
  H5Aclose(copy);
  H5Sclose(space);
  H5Tclose(type);
  H5Aclose(attribute);
  return 0;
}

/// The same recording in HDF5's oldest format, as other programs write it: nothing in it has a checksum.
void copy_without_checksums(const std::string& from, const std::string& to) {
  const hid_t source = H5Fopen(from.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  hid_t target = H5Fcreate(to.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Aiterate2(source, H5_INDEX_NAME, H5_ITER_INC, nullptr, copy_attribute, &target);
  for (const char* name : {"steps", "placements", "checksums", "observations", "actions", "terminations",
                           "truncations", "zero_current"})
    REQUIRE(H5Ocopy(source, name, target, name, H5P_DEFAULT, H5P_DEFAULT) >= 0);
  H5Fclose(target);
  H5Fclose(source);
}

}  // namespace

TEST_CASE("a spoiled recording in HDF5 is read or refused by name", "[soak]") {
  const tests::Soak soak("spoiled HDF5 recordings", 500, 100'000);
  const tests::TemporaryFolder folder;
  data::write_dataset(folder / "good.h5", tests::random_dataset(2, 3));
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  copy_without_checksums(folder / "good.h5", folder / "old.h5");
  REQUIRE(data::read_dataset(folder / "old.h5").transitions() == 6);
  const std::vector<std::string> good = {common::read_file(folder / "good.h5"),
                                         common::read_file(folder / "old.h5"),
                                         common::read_file(LODESTONE_SOURCE_DIR "/tests/data/version_2.h5")};
  tests::Spoiler spoiler(soak.seed(), "hdf5");
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        const std::string& from = spoiler.one_of(good);
        const bool bytes = spoiler.below(3) != 0;
        tests::write_bytes(folder / "a.h5", bytes ? spoiler.bytes(from, spoiler.one_of(good)) : from);
        if (!bytes) replace_something(folder / "a.h5", spoiler);
      },
      [&] { data::read_dataset(folder / "a.h5"); });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count());
}
