#include "lodestone/physics/modelled_field.h"

#include <catch2/catch.hpp>

#include "lodestone/physics/standing_coil.h"
#include "measured_rig.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("the paper's coils are modelled as point dipoles") {
  const RigDescription rig;
  FieldGradient wanted;
  DipoleCoil(rig.coils.geometry, 1).add(3.0, {0.01, -0.005}, wanted);
  DipoleCoil(rig.coils.geometry, 2).add(2.0, {0.01, -0.005}, wanted);
  const FieldGradient found = ModelledField(rig).at({0.0, 3.0, 2.0, 0.0}, {0.01, -0.005});
  CHECK(found.field_T == wanted.field_T);
  CHECK(found.gradient_T_per_m == wanted.gradient_T_per_m);
}

TEST_CASE("coils that are listed are modelled by their exact field, and its slope") {
  const RigDescription rig = tests::ring_rig(8, 0.03);
  const ModelledField field(rig);
  const Vector2 point_m(0.012, -0.021);
  const FieldGradient found = field.at({0.0, 2.0, 0.0, 0.0, 0.0, 5.0}, point_m);
  const StandingCoil two(rig.coils.coil(1)), six(rig.coils.coil(5));
  const auto exact_T = [&](const Vector2& at_m) {
    const Eigen::Vector3d spot_m(at_m.x(), at_m.y(), 0.0);
    return Vector2((2.0 * two.per_ampere(spot_m) + 5.0 * six.per_ampere(spot_m)).head<2>());
  };
  CHECK((found.field_T - exact_T(point_m)).norm() < 1e-3 * found.field_T.norm());
  for (int axis = 0; axis < 2; ++axis) {
    const Vector2 step_m = 1e-5 * Vector2::Unit(axis);
    const Vector2 slope = (exact_T(point_m + step_m) - exact_T(point_m - step_m)) / 2e-5;
    CHECK((found.gradient_T_per_m.col(axis) - slope).norm() < 0.02 * found.gradient_T_per_m.norm());
  }
  CHECK_NOTHROW(field.at({1.0}, {0.3, 0.3}));
}

TEST_CASE("coils that were measured are modelled as they were, with what is there without current") {
  const ModelledField windings(tests::small_ring_rig()), measured(tests::measured_small_ring_rig());
  const Vector2 point_m(0.006, -0.011);
  const FieldGradient want = windings.at({0.0, 5.0, 0.0, -4.0}, point_m);
  const FieldGradient found = measured.at({0.0, 5.0, 0.0, -4.0}, point_m);
  CHECK((found.field_T - Vector2(40e-6, 0.0) - want.field_T).norm() < 0.02 * want.field_T.norm());
  CHECK((found.gradient_T_per_m - want.gradient_T_per_m).norm() < 0.05 * want.gradient_T_per_m.norm());
  CHECK((measured.at({}, point_m).field_T - Vector2(40e-6, 0.0)).norm() < 4e-6);
}

TEST_CASE("fields are shared while somebody holds them") {
  const RigDescription rig = tests::ring_rig(6);
  const auto one = CoilFields::shared(rig.coils, 0.0425, 0.0, 4e-3);
  CHECK(CoilFields::shared(rig.coils, 0.0425, 0.0, 4e-3) == one);
  CHECK(CoilFields::shared(rig.coils, 0.04, 0.0, 4e-3) != one);
  CHECK(CoilFields::shared(tests::ring_rig(6, 0.01).coils, 0.0425, 0.0, 4e-3) != one);
  CHECK(CoilFields::shared(CoilsDescription{}, 0.0425, 0.0, 4e-3) != one);
}

}  // namespace
}  // namespace lodestone::physics
