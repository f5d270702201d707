#include "lodestone/vision/commanded_field.h"

#include <catch2/catch.hpp>

#include "lodestone/geometry/angle.h"

using namespace lodestone;

TEST_CASE("the commanded field points along the coils that are on") {
  const physics::RigDescription rig;
  const vision::CommandedField field(rig);
  CHECK(*field.direction_rad({5.0, 0.0, 0.0, 0.0}, {0.0, 0.0}) == Approx(0.0).margin(1e-3));
  CHECK(*field.direction_rad({0.0, 0.0, 0.0, 3.0}, {0.0, 0.0}) == Approx(-0.5 * geometry::kPi).margin(1e-3));
  CHECK(*field.direction_rad({4.0, 0.0, 4.0, 0.0}, {0.0, 0.0}) == Approx(0.25 * geometry::kPi).margin(1e-3));
  CHECK_FALSE(field.direction_rad({}, {0.01, 0.0}));
  // Beside the axis it fans out, and outside the dish it is that of its edge.
  CHECK(*field.direction_rad({5.0, 0.0, 0.0, 0.0}, {0.03, 0.02}) != Approx(0.0).margin(0.05));
  CHECK(*field.direction_rad({5.0, 0.0, 0.0, 0.0}, {0.0, 0.2}) ==
        *field.direction_rad({5.0, 0.0, 0.0, 0.0}, {0.0, rig.dish.radius_m}));
}
