#include <hdf5.h>

#include "data/synthetic.h"
#include "fuzz.h"
#include "lodestone/data/dataset_file.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// Puts an array of a random type, shape, layout and content into the place of one of an episode, or an attribute
/// of a random type into the place of one of the root: what a checksum of HDF5's own would never let through.
void replace_something(const std::string& path, tests::Spoiler& spoiler) {
  const std::vector<const char*> arrays = {"episode_0/observations", "episode_0/actions", "episode_1/terminations",
                                           "episode_1/infos/zero_current"};
  const std::vector<const char*> attributes = {"format",       "layout",       "action_unit", "action_scale",
                                               "format_version", "control_period_s", "rig",   "workspace_radius_m"};
  const std::vector<hid_t> types = {H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_INT8, H5T_STD_U64BE, H5T_C_S1,
                                    H5T_NATIVE_LDOUBLE};
  const std::vector<hsize_t> lengths = {0, 1, 2, 3, 4, 5, 300, 5000, 4'000'000'000};
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hsize_t shape[3] = {spoiler.one_of(lengths), spoiler.one_of(lengths), 1};
  const hid_t space =
      spoiler.below(8) == 0 ? H5Screate(H5S_NULL) : H5Screate_simple(static_cast<int>(spoiler.below(4)), shape, nullptr);
  const hid_t type = H5Tcopy(spoiler.one_of(types));
  if (H5Tget_class(type) == H5T_STRING) H5Tset_size(type, spoiler.below(2) == 0 ? 7 : 5000);
  std::vector<char> noise(64 * 1024);
  for (std::size_t i = 0; i < 64; ++i) noise[spoiler.below(noise.size())] = static_cast<char>(spoiler.below(256));
  if (spoiler.below(2) == 0) {
    const char* name = spoiler.one_of(arrays);
    H5Ldelete(file, name, H5P_DEFAULT);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[3] = {spoiler.one_of(lengths), 1 + spoiler.below(3), 1};
    if (spoiler.below(3) == 0) H5Pset_chunk(creation, 1 + static_cast<int>(spoiler.below(2)), chunk);
    const hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (dataset >= 0 && H5Sget_simple_extent_npoints(space) <= 4000)
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, noise.data());
    if (dataset >= 0) H5Dclose(dataset);
    H5Pclose(creation);
  } else {
    const char* name = spoiler.one_of(attributes);
    H5Adelete(file, name);
    const hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute >= 0 && H5Sget_simple_extent_npoints(space) <= 9) H5Awrite(attribute, type, noise.data());
    if (attribute >= 0) H5Aclose(attribute);
  }
  H5Tclose(type);
  H5Sclose(space);
  H5Fclose(file);
}

}  // namespace

TEST_CASE("a spoiled recording in HDF5 is read or refused by name", "[soak]") {
  const tests::Soak soak("spoiled HDF5 recordings", 500, 100'000);
  const tests::TemporaryFolder folder;
  data::write_dataset(folder / "good.h5", tests::random_dataset(2, 3));
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::string good = common::read_file(folder / "good.h5");
  tests::Spoiler spoiler(soak.seed(), "hdf5");
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        const bool bytes = spoiler.below(2) == 0;
        tests::write_bytes(folder / "a.h5", bytes ? spoiler.bytes(good, good) : good);
        if (!bytes) replace_something(folder / "a.h5", spoiler);
      },
      [&] { data::read_dataset(folder / "a.h5"); });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count());
}
