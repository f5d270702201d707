#include "lodestone/control/driven_field.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

TEST_CASE("an axis drive is the field of the coil that its sign picks") {
  const physics::CoilGeometry coil = tests::paper_rig().coils.geometry;
  const control::DrivenField field(tests::paper_rig());
  const Vector2 point(0.01, -0.005);
  physics::FieldGradient expected;
  physics::DipoleCoil(coil, 1).add(3.0, point, expected);  // -x
  physics::DipoleCoil(coil, 2).add(2.0, point, expected);  // +y
  const physics::FieldGradient found = field.at({-3.0, 2.0}, point);
  CHECK((found.field_T - expected.field_T).norm() < 1e-15);
  CHECK((found.gradient_T_per_m - expected.gradient_T_per_m).norm() < 1e-12);
  CHECK(field.at({0.0, 0.0}, point).field_T.isZero(0.0));
}

TEST_CASE("the drive is found whose effect points the wanted way, or nearly") {
  const auto skewed = [](const Vector2& drive) { return Vector2(2.0 * drive.x() + drive.y(), drive.y()); };
  for (const double angle : {0.2, 1.7, -2.4}) {
    const Vector2 wanted(std::cos(angle), std::sin(angle));
    const Vector2 drive = control::unit_drive_along(wanted, skewed);
    CHECK(drive.norm() == Approx(1.0));
    CHECK(skewed(drive).normalized().dot(wanted) > 1.0 - 1e-7);
  }
  const auto to_the_right = [](const Vector2& drive) { return Vector2(1.0, 0.2 * drive.y()); };
  CHECK(control::unit_drive_along({0.0, 1.0}, to_the_right).y() == Approx(1.0).margin(1e-6));
}
