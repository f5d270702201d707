#include "lodestone/physics/four_coils.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("frames of the four coils: their own +x axis points to them, exactly") {
  const Vector2 directions[] = {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}};
  for (int coil = 0; coil < kFourCoils; ++coil) {
    CHECK(coil_direction(coil) == directions[coil]);
    CHECK(to_coil_frame(coil, directions[coil]) == Vector2(1.0, 0.0));
    CHECK(from_coil_frame(coil, to_coil_frame(coil, {0.3, -0.7})) == Vector2(0.3, -0.7));
  }
  CHECK_THROWS_AS(to_coil_frame(4, {1.0, 0.0}), common::LogicFault);
}

}  // namespace
}  // namespace lodestone::physics
