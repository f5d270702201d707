#include "lodestone/physics/field_allocation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/needle.h"
#include "other_rigs.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

const Vector2 kCentre(0.0, 0.0);

Vector2 along(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

CoilArray coils_of(const RigDescription& rig) {
  return CoilArray(CoilFields::shared(rig.coils, rig.dish.radius_m));
}

/// Pull (N) of a full drive on a needle that lies along it.
Vector2 pull_N(const RigDescription& rig, const CoilArray& coils, const PerCoil& current_A,
               const Vector2& place_m, double angle_rad) {
  const Wrench wrench = magnetic_wrench(rig.needle, place_m, along(angle_rad), coils, current_A);
  return {wrench.force_x_N, wrench.force_y_N};
}

TEST_CASE("a field drive turns and pulls the needle alike in every direction") {
  for (const RigDescription& rig :
       {tests::ring_rig(6), tests::ring_rig(5), tests::ring_rig(8, 0.03), tests::ring_rig(4, 0.0, true)}) {
    const FieldAllocation allocation(rig);
    const CoilArray coils = coils_of(rig);
    const double full_N = rig.needle.moment_A_m2 * allocation.pull_T_per_m();
    REQUIRE(full_N > 0.0);
    for (double angle_rad = 0.02; angle_rad < 6.28; angle_rad += 0.1) {
      const Vector2 axis = along(angle_rad), aside(-axis.y(), axis.x());
      const PerCoil current_A = allocation.current_A(angle_rad, kCentre);
      const Vector2 pull = pull_N(rig, coils, current_A, kCentre, angle_rad);
      CHECK(pull.dot(axis) == Approx(full_N).epsilon(0.1));
      CHECK(std::abs(pull.dot(aside)) < 0.15 * full_N);
      const Vector2 field_T = coils.field_T(current_A, kCentre);
      CHECK(std::abs(field_T.dot(aside)) < 0.25 * field_T.dot(axis));
      for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) {
        CHECK(current_A[coil] >= rig.coils.smallest_A(coil) - 1e-12);
        CHECK(current_A[coil] <= rig.coils.largest_A(coil) + 1e-12);
      }
    }
  }
}

/// How far from the wanted pull a full drive is on average over the dish, as a share of it.
double pull_error(const RigDescription& rig, bool at_centre) {
  const FieldAllocation allocation(rig);
  const CoilArray coils = coils_of(rig);
  const double full_N = rig.needle.moment_A_m2 * allocation.pull_T_per_m();
  double error = 0.0;
  int count = 0;
  for (double around_rad = 0.1; around_rad < 6.28; around_rad += 0.7)
    for (double angle_rad = 0.02; angle_rad < 6.28; angle_rad += 0.3, ++count) {
      const Vector2 place_m = 0.5 * rig.dish.radius_m * along(around_rad);
      const PerCoil current_A = allocation.current_A(angle_rad, at_centre ? kCentre : place_m);
      error +=
          (pull_N(rig, coils, current_A, place_m, angle_rad) - full_N * along(angle_rad)).norm() / full_N;
    }
  return error / count;
}

TEST_CASE("away from the centre, the currents are those for where the needle is") {
  for (const RigDescription& rig : {tests::ring_rig(6), tests::ring_rig(8, 0.03)})
    CHECK(pull_error(rig, false) < 0.6 * pull_error(rig, true));
}

TEST_CASE("a field and a pull of their own: backwards, and across the needle") {
  const RigDescription rig = tests::ring_rig(8, 0.03, true);
  const FieldAllocation allocation(rig);
  const CoilArray coils = coils_of(rig);
  const double full_N = rig.needle.moment_A_m2 * allocation.pull_T_per_m();
  for (double angle_rad = 0.02; angle_rad < 6.28; angle_rad += 0.2) {
    const Vector2 axis = along(angle_rad), aside(-axis.y(), axis.x());
    for (const Vector2& wanted :
         {Vector2(-0.3 * axis), Vector2(0.3 * aside), Vector2(0.2 * (axis - aside))}) {
      const PerCoil current_A = allocation.current_A(0.5 * axis, wanted, kCentre);
      const Vector2 pull = pull_N(rig, coils, current_A, kCentre, angle_rad);
      CHECK((pull - full_N * wanted).norm() < 0.1 * full_N);
      const Vector2 field_T = coils.field_T(current_A, kCentre);
      CHECK(field_T.dot(axis) > 0.0);
      CHECK(std::abs(field_T.dot(aside)) < 0.2 * field_T.dot(axis));
    }
  }
  CHECK(allocation.current_A(Vector2(0.0, 0.0), Vector2(0.0, 0.0), kCentre) == PerCoil{});
}

TEST_CASE("coils that are driven one by one do what they can where they lack a direction") {
  RigDescription rig = tests::ring_rig(6);
  rig.coils.each.resize(2);
  rig.drive.kind = DriveKind::kIndependent;
  const FieldAllocation allocation(rig);
  double most_A = 0.0;
  for (const double current_A : allocation.current_A(0.0, kCentre)) most_A = std::max(most_A, current_A);
  CHECK(most_A > 0.0);
}

TEST_CASE("outside the dish a needle is given what it is given at the wall") {
  const RigDescription rig = tests::ring_rig(6);
  const FieldAllocation allocation(rig);
  CHECK(allocation.current_A(1.0, {5.0, 0.0}) == allocation.current_A(1.0, {1.0, 0.0}));
}

TEST_CASE("coils of which only one may be on never are together") {
  RigDescription rig = tests::ring_rig(6);
  for (std::size_t coil = 0; coil < 3; ++coil) rig.coils.each[coil].not_with = {rig.coils.name(coil + 3)};
  const FieldAllocation allocation(rig);
  for (double angle_rad = 0.0; angle_rad < 6.28; angle_rad += 0.037)
    for (const Vector2& place_m : {kCentre, Vector2(0.01, 0.017)}) {
      const PerCoil current_A = allocation.current_A(angle_rad, place_m);
      for (std::size_t coil = 0; coil < 3; ++coil) CHECK(current_A[coil] * current_A[coil + 3] == 0.0);
    }
}

TEST_CASE("equal rigs share one allocation, others have their own") {
  const RigDescription rig = tests::ring_rig(6);
  const auto allocation = FieldAllocation::shared(rig);
  CHECK(FieldAllocation::shared(tests::ring_rig(6)) == allocation);
  RigDescription other = rig;
  other.drive.field_share = 0.7;
  CHECK(FieldAllocation::shared(other) != allocation);
}

TEST_CASE("coils on one side only are refused, with the direction that they lack") {
  RigDescription rig = tests::ring_rig(6);
  rig.coils.each.resize(2);
  CHECK_THROWS_WITH(FieldAllocation(rig), Catch::Contains("cannot pull the needle along"));
  rig = tests::ring_rig(6);
  rig.coils.max_current_A = 0.0;
  CHECK_THROWS_WITH(FieldAllocation(rig), Catch::Contains("coils.max_current_A = 0"));
}

}  // namespace
}  // namespace lodestone::physics
