#include "lodestone/common/error.h"

#include <catch2/catch.hpp>

using namespace lodestone::common;

TEST_CASE("errors carry the program's exit code") {
  CHECK(ConfigError("a key").exit_code() == 2);
  CHECK(Interrupted("stopped").exit_code() == 130);
  CHECK(DataError("a file").exit_code() == 1);
}

TEST_CASE("a broken invariant names itself, its place and what was expected") {
  const int rows = 3;
  CHECK_NOTHROW([&] { LODESTONE_CHECK(rows == 3, "three rows"); }());
  CHECK_THROWS_WITH([&] { LODESTONE_CHECK(rows == 4, "four rows, not " + std::to_string(rows)); }(),
                    Catch::Contains("four rows, not 3") && Catch::Contains("rows == 4") &&
                        Catch::Contains("error_test.cpp:"));
}
