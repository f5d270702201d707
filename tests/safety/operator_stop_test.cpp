#include "lodestone/safety/operator_stop.h"

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "lodestone/safety/check.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("a stop file is looked for at every check") {
  const tests::TemporaryFolder folder;
  safety::OperatorStop stop(folder / "STOP");
  CHECK_NOTHROW(stop.check());
  common::write_file_atomically(folder / "STOP", "");
  CHECK_THROWS_WITH(stop.check(), Catch::Contains("stopped by the user") && Catch::Contains("STOP exists"));
  CHECK_THROWS_AS(stop.check(), safety::Distrust);
}
