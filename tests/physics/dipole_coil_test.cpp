#include "lodestone/physics/dipole_coil.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/physics/finite_coil.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("a finite coil looks like its dipole from afar and is weaker near by") {
  CoilGeometry geometry = published_coil_geometry();
  const auto ratio = [&](double x) {
    const FiniteCoil exact(geometry);
    FieldGradient dipole;
    DipoleCoil(geometry, 0).add(1.0, {x, 0.0}, dipole);
    return dipole.field_T.x() / exact.in_dish_plane({x, 0.0}).x();
  };
  // Errors of the point dipole from the design notes.
  CHECK(ratio(-0.040) == Approx(1.12).epsilon(0.02));
  CHECK(ratio(0.0) == Approx(1.32).epsilon(0.02));
  CHECK(ratio(0.040) == Approx(3.15).epsilon(0.02));
  CHECK(ratio(-3.0) == Approx(1.0).epsilon(1e-3));
  FieldGradient dipole;
  const Vector2 far(-0.9, 1.7);
  DipoleCoil(geometry, 0).add(1.0, far, dipole);
  const Vector2 exact = FiniteCoil(geometry).in_dish_plane(far);
  CHECK((dipole.field_T - exact).norm() < 2e-3 * exact.norm());
}

TEST_CASE("dipole gradient is the derivative of its field") {
  const DipoleCoil coil(CoilGeometry{}, 2);
  const Vector2 point(0.013, -0.021);
  FieldGradient centre;
  coil.add(7.0, point, centre);
  const double h = 1e-6;
  for (int j = 0; j < 2; ++j) {
    FieldGradient ahead, behind;
    coil.add(7.0, point + h * Vector2::Unit(j), ahead);
    coil.add(7.0, point - h * Vector2::Unit(j), behind);
    const Vector2 numeric = (ahead.field_T - behind.field_T) / (2.0 * h);
    CHECK((centre.gradient_T_per_m.col(j) - numeric).norm() < 1e-6 * centre.gradient_T_per_m.norm());
  }
}

}  // namespace
}  // namespace lodestone::physics
