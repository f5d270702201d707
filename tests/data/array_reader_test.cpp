#include "array_reader.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

TEST_CASE("an array is read as its shape says, and nothing else is") {
  const tests::TemporaryFolder folder;
  data::silence_hdf5();
  const data::Handle file = data::create_file(folder / "a.h5", H5P_DEFAULT);
  const std::vector<double> numbers = {1.5, 2.5, 3.5, 4.5, 5.5, 6.5};
  REQUIRE(data::write_array(file.get(), "x", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, numbers.data(), {3, 2}));
  data::ArrayReader reader(1000);
  std::vector<double> values;
  CHECK(reader.read(file.get(), "x", 2, values, "here") == 3);
  CHECK(values == numbers);
  std::vector<std::int64_t> whole;
  CHECK(reader.read(file.get(), "x", 2, whole, "here") == 3);
  CHECK(whole == std::vector<std::int64_t>{1, 2, 3, 4, 5, 6});
  CHECK_THROWS_WITH(reader.read(file.get(), "x", 3, values, "here"), Contains("here: dataset 'x'"));
  CHECK_THROWS_WITH(reader.read(file.get(), "x", 1, values, "here"), Contains("another shape"));
  CHECK_THROWS_WITH(reader.read(file.get(), "y", 1, values, "here"), Contains("missing"));
}

TEST_CASE("all arrays of a file together are no larger than it could hold") {
  const tests::TemporaryFolder folder;
  data::silence_hdf5();
  const data::Handle file = data::create_file(folder / "a.h5", H5P_DEFAULT);
  const std::vector<std::uint8_t> bytes(1000, 7);
  REQUIRE(data::write_array(file.get(), "x", H5T_STD_U8LE, H5T_NATIVE_UINT8, bytes.data(), {1000}));
  data::ArrayReader reader(1000 / 16);  // 64 times that are 3,968 bytes
  std::vector<std::uint8_t> values;
  for (int i = 0; i < 3; ++i) CHECK(reader.read(file.get(), "x", 1, values, "here") == 1000);
  CHECK_THROWS_WITH(reader.read(file.get(), "x", 1, values, "here"), Contains("more than the file can hold"));
}
