#include "hdf5_handle.h"

#include <catch2/catch.hpp>

#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("attributes come back as they were written, and only as their own type") {
  const tests::TemporaryFolder folder;
  data::silence_hdf5();
  const data::Handle file(H5Fcreate((folder / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                          H5Fclose);
  REQUIRE(file.valid());
  REQUIRE(data::write_attribute(file.get(), "unit", std::string("A")));
  REQUIRE(data::write_attribute(file.get(), "scale", 15.5));
  REQUIRE(data::write_attribute(file.get(), "count", std::int64_t{7}));
  std::string unit;
  double scale = 0.0;
  std::int64_t count = 0;
  CHECK((data::read_attribute(file.get(), "unit", unit) && unit == "A"));
  CHECK((data::read_attribute(file.get(), "scale", scale) && scale == 15.5));
  CHECK((data::read_attribute(file.get(), "count", count) && count == 7));
  CHECK_FALSE(data::read_attribute(file.get(), "nothing", scale));
  CHECK_FALSE(data::read_attribute(file.get(), "unit", scale));
  const double values[] = {1.0, 2.0};
  CHECK(data::write_array(file.get(), "values", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values, {2}));
  CHECK_FALSE(data::write_array(file.get(), "values", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values, {2}));
  CHECK_FALSE(data::open_group(file.get(), "nowhere").valid());
  CHECK(H5Gopen2(file.get(), "nowhere", H5P_DEFAULT) < 0);
  CHECK_FALSE(data::because_of_hdf5().empty());
}

TEST_CASE("a handle is closed once, by its last owner") {
  data::Handle handle(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hid_t id = handle.get();
  data::Handle owner = std::move(handle);
  CHECK_FALSE(handle.valid());
  CHECK(H5Iis_valid(id) > 0);
  owner.reset();
  CHECK(H5Iis_valid(id) == 0);
}

TEST_CASE("an attribute of several texts is none, and is not written beyond the one that was asked for") {
  const tests::TemporaryFolder folder;
  data::silence_hdf5();
  const data::Handle file(H5Fcreate((folder / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                          H5Fclose);
  const hsize_t count = 1000;
  const data::Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const data::Handle attribute(
      H5Acreate2(file.get(), "unit", H5T_C_S1, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  REQUIRE(attribute.valid());
  std::string unit;
  CHECK_FALSE(data::read_attribute(file.get(), "unit", unit));
}
