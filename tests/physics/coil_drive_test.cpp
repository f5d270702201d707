#include "lodestone/physics/coil_drive.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "other_rigs.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("opposed pairs: the sign picks the coil, wherever the needle is") {
  CHECK(opposed_pairs_A({3.0, -2.0}) == PerCoil{3.0, 0.0, 0.0, 2.0});
  CHECK(CoilDrive().current_A({-1.0, 0.5}, Vector2(0.0, 0.0)) == PerCoil{0.0, 1.0, 0.5, 0.0});
  CHECK(CoilDrive(RigDescription{}).current_A({-1.0, 0.5}, Vector2(0.0, 0.0)).size() == 4);
  CHECK(CoilDrive(RigDescription{}).current_A({-1.0, 0.5}, {0.02, -0.01}) == PerCoil{0.0, 1.0, 0.5, 0.0});
}

TEST_CASE(
    "half a field drive is half of each current, and one beyond the coils' limits keeps its direction") {
  const RigDescription rig = tests::ring_rig(8, 0.03);
  const CoilDrive drive(rig);
  REQUIRE(drive.coils() == 8);
  for (const Vector2& place_m : {Vector2(0.0, 0.0), Vector2(0.015, -0.01)})
    for (double angle_rad = 0.02; angle_rad < 6.28; angle_rad += 0.1) {
      const Vector2 full_A = rig.coils.max_current_A * Vector2(std::cos(angle_rad), std::sin(angle_rad));
      const PerCoil full = drive.current_A(full_A, place_m), half = drive.current_A(0.5 * full_A, place_m);
      const PerCoil beyond = drive.current_A(40.0 * full_A, place_m);
      double most = 0.0;
      for (std::size_t coil = 0; coil < drive.coils(); ++coil) {
        CHECK(half[coil] == Approx(0.5 * full[coil]).margin(1e-12));
        CHECK(beyond[coil] * rig.coils.max_current_A >= full[coil] * full[coil]);
        CHECK(beyond[coil] >= rig.coils.smallest_A(coil));  // drivers refuse a bit more
        CHECK(beyond[coil] <= rig.coils.largest_A(coil));
        most = std::max(most, beyond[coil] / rig.coils.largest_A(coil));
      }
      CHECK(most == Approx(1.0));
    }
  CHECK(drive.current_A({0.0, 0.0}, Vector2(0.0, 0.0)) == PerCoil{});
}

RigDescription independent(RigDescription rig) {
  rig.drive.kind = DriveKind::kIndependent;
  return rig;
}

RigDescription field_of(int numbers, RigDescription rig) {
  rig.drive.field_numbers = numbers;
  return rig;
}

TEST_CASE("independent: each number is the current of its coil, as far as that goes") {
  RigDescription rig = independent(tests::ring_rig(6));
  rig.coils.each[1].max_current_A = 0.5 * rig.coils.max_current_A;
  rig.coils.each[2].bipolar = true;
  rig.coils.each[4].not_with = {rig.coils.name(5)};
  CHECK(rig.drive_size() == 6);
  const CoilDrive drive(rig);
  REQUIRE(drive.size() == 6);
  const double full_A = rig.coils.max_current_A;
  const geometry::Drive asked_A = full_A * geometry::Drive{0.2, 0.5, -0.4, -0.3, 0.6, 0.5};
  const PerCoil given = drive.current_A(asked_A, {0.01, 0.0});
  CHECK(given == PerCoil{0.2 * full_A, 0.25 * full_A, -0.4 * full_A, 0.0, 0.6 * full_A, 0.0});
  CHECK(drive.current_A(3.0 * asked_A, {0.01, 0.0})[4] == full_A);
  CHECK_THROWS_AS(drive.current_A({1.0, 2.0}, Vector2(0.0, 0.0)), common::LogicFault);
  CHECK(drive.least(0) == 0.0);
  CHECK(drive.least(2) == -1.0);
  CHECK(drive.turned(asked_A, 1.0) == asked_A);  // it has no direction of its own
  // The paper's four take either sign, and opposite ones are never on together.
  const CoilDrive four(independent(RigDescription{}));
  CHECK(four.current_A({3.0, 5.0, -2.0, 1.0}, Vector2(0.0, 0.0)) == PerCoil{0.0, 5.0, -2.0, 0.0});
}

TEST_CASE("what two numbers mean is near the same for every kind of drive") {
  const RigDescription rig = tests::ring_rig(8, 0.03);
  const Vector2 place_m(0.012, -0.008);
  const CoilDrive two(rig), alone(independent(rig)), three(field_of(3, rig)), four(field_of(4, rig));
  CHECK(three.size() == 3);
  CHECK(four.size() == 4);
  for (double angle_rad = 0.05; angle_rad < 6.28; angle_rad += 0.3) {
    const Vector2 direction_A =
        0.4 * rig.coils.max_current_A * Vector2(std::cos(angle_rad), std::sin(angle_rad));
    CHECK(two.along(direction_A, place_m) == direction_A);
    const PerCoil wanted = two.current_A(direction_A, place_m);
    for (const CoilDrive& drive : {alone, three, four}) {
      const PerCoil given = drive.current_A(drive.along(direction_A, place_m), place_m);
      for (std::size_t coil = 0; coil < 8; ++coil)  // the table interpolates between places and directions
        CHECK(given[coil] == Approx(wanted[coil]).margin(0.12 * rig.coils.max_current_A));
    }
  }
  CHECK(alone.along({0.0, 0.0}, place_m) == geometry::Drive::Zero(8));
}

TEST_CASE("field and pull turn together, and half of a drive of both is half of each current") {
  const RigDescription rig = field_of(4, tests::ring_rig(8, 0.03));
  const CoilDrive drive(rig);
  const geometry::Drive turned = drive.turned({1.0, 0.0, 0.0, 1.0}, 0.5 * 3.14159265358979323846);
  CHECK((turned - geometry::Drive{0.0, 1.0, -1.0, 0.0}).norm() < 1e-12);
  const geometry::Drive full_A = 0.3 * rig.coils.max_current_A * geometry::Drive{0.8, 0.6, -0.5, 0.2};
  const PerCoil full = drive.current_A(full_A, {0.01, 0.0});
  const PerCoil half = drive.current_A(0.5 * full_A, {0.01, 0.0});
  for (std::size_t coil = 0; coil < 8; ++coil) CHECK(half[coil] == Approx(0.5 * full[coil]).margin(1e-12));
  CHECK(drive.current_A(geometry::Drive::Zero(4), Vector2(0.0, 0.0)) == PerCoil{});
  const CoilDrive three(field_of(3, rig));
  CHECK(three.current_A({0.0, 0.0, 5.0}, Vector2(0.0, 0.0)) == PerCoil{});  // along what?
}

}  // namespace
}  // namespace lodestone::physics
