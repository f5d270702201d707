#include "lodestone/physics/coil_array.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/physics/field_table.h"
#include "lodestone/physics/four_coils.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("four coils: positive current makes a field towards the coil, strongest near it") {
  const CoilArray coils(make_field_table(CoilGeometry{}, 0.0425));
  for (int coil = 0; coil < kFourCoils; ++coil) {
    PerCoil current{};
    current[static_cast<std::size_t>(coil)] = 1.0;
    const Vector2 direction = coil_direction(coil);
    const Vector2 side(-direction.y(), direction.x());
    CHECK((from_coil_frame(coil, to_coil_frame(coil, {0.3, -0.7})) - Vector2(0.3, -0.7)).norm() == 0.0);
    const Vector2 centre = coils.field_T(current, {0.0, 0.0});
    CHECK(centre.dot(direction) > 0.5e-3);
    CHECK(std::abs(centre.dot(side)) < 1e-12);
    CHECK(coils.field_T(current, 0.03 * direction).dot(direction) > 2.0 * centre.dot(direction));
    // The same field in every coil's own frame.
    const Vector2 point = 0.01 * direction + 0.02 * side;
    CHECK((to_coil_frame(coil, coils.field_T(current, point)) -
           coils.field_T({1.0, 0.0, 0.0, 0.0}, {0.01, 0.02}))
              .norm() < 1e-15);
  }
  const Vector2 point(0.011, -0.007);
  const Vector2 both = coils.field_T({2.0, 0.0, 0.0, -3.0}, point);
  CHECK((both - coils.field_T({2.0, 0.0, 0.0, 0.0}, point) - coils.field_T({0.0, 0.0, 0.0, -3.0}, point))
            .norm() < 1e-15);
}

}  // namespace
}  // namespace lodestone::physics
