#include "lodestone/physics/coil_description.h"

#include <catch2/catch.hpp>

namespace lodestone::physics {
namespace {

TEST_CASE("where a coil's winding is") {
  CoilDescription coil;
  coil.name = "north";
  coil.position_m = {0.0, 0.08, 0.0};
  CHECK_NOTHROW(coil.validate());
  CHECK((coil.unit_axis() - Eigen::Vector3d::UnitY()).norm() == 0.0);
  CHECK(coil.winds_at({0.04, 0.08, 0.0}));
  CHECK(coil.winds_at({0.0, 0.06, 0.04}));
  CHECK_FALSE(coil.winds_at({0.0, 0.08, 0.0}));   // in its bore
  CHECK_FALSE(coil.winds_at({0.04, 0.04, 0.0}));  // before its face
  CHECK(coil.winds_at({0.04, 0.0495, 0.0}, 1e-3));
  CHECK_FALSE(coil.winds_at({0.06, 0.08, 0.0}));
  coil.axis = {0.0, 0.0, -2.0};
  CHECK((coil.unit_axis() + Eigen::Vector3d::UnitZ()).norm() == 0.0);
  CHECK(coil.winds_at({0.0, 0.04, 0.02}));
}

}  // namespace
}  // namespace lodestone::physics
