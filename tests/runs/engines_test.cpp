#include "lodestone/runs/engines.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("there is an engine of every name, and of no other") {
  for (const std::string& name : runs::engine_names()) CHECK(runs::make_engine(name) != nullptr);
  CHECK_THROWS_WITH(runs::make_engine("make"), "--engine make must be ninja or slurm");
}
