#include "lodestone/physics/coil_drive.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/needle.h"
#include "other_rigs.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

Vector2 along(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

/// What a drive does to a needle that lies at the centre along it.
Wrench wrench_of(const RigDescription& rig, const CoilArray& coils, const CoilDrive& drive, double angle_rad,
                 double share) {
  return magnetic_wrench(rig.needle, {0.0, 0.0}, along(angle_rad), coils,
                         drive.current_A(share * rig.coils.max_current_A * along(angle_rad)));
}

TEST_CASE("opposed pairs: the sign picks the coil") {
  CHECK(opposed_pairs_A({3.0, -2.0}) == PerCoil{3.0, 0.0, 0.0, 2.0});
  CHECK(CoilDrive().current_A({-1.0, 0.5}) == PerCoil{0.0, 1.0, 0.5, 0.0});
  CHECK(CoilDrive(RigDescription{}).current_A({-1.0, 0.5}).size() == 4);
}

TEST_CASE("a field drive turns and pulls the needle alike in every direction") {
  for (const RigDescription& rig :
       {tests::ring_rig(6), tests::ring_rig(5), tests::ring_rig(8, 0.03), tests::ring_rig(4, 0.0, true)}) {
    const CoilDrive drive(rig);
    const CoilArray coils(std::make_shared<const CoilFields>(rig.coils, rig.dish.radius_m));
    REQUIRE(drive.coils() == rig.coils.count());
    REQUIRE(drive.full_pull_N() > 0.0);
    for (double angle_rad = 0.02; angle_rad < 6.28; angle_rad += 0.1) {
      const Vector2 axis = along(angle_rad), aside(-axis.y(), axis.x());
      const Wrench full = wrench_of(rig, coils, drive, angle_rad, 1.0);
      const Vector2 pull(full.force_x_N, full.force_y_N);
      CHECK(pull.dot(axis) == Approx(drive.full_pull_N()).epsilon(0.1));
      CHECK(std::abs(pull.dot(aside)) < 0.15 * drive.full_pull_N());
      const PerCoil current_A = drive.current_A(rig.coils.max_current_A * axis);
      const Vector2 field_T = coils.field_T(current_A, {0.0, 0.0});
      CHECK(std::abs(field_T.dot(aside)) < 0.25 * field_T.dot(axis));
      for (std::size_t coil = 0; coil < drive.coils(); ++coil) {
        CHECK(current_A[coil] >= rig.coils.smallest_A(coil) - 1e-12);
        CHECK(current_A[coil] <= rig.coils.largest_A(coil) + 1e-12);
      }
      // Half the drive is half of everything; one beyond the coils' limits keeps its direction.
      const Wrench half = wrench_of(rig, coils, drive, angle_rad, 0.5);
      CHECK(half.force_x_N == Approx(0.5 * full.force_x_N).margin(1e-12));
      const PerCoil beyond_A = drive.current_A(40.0 * rig.coils.max_current_A * axis);
      double most = 0.0;
      for (std::size_t coil = 0; coil < drive.coils(); ++coil)
        most = std::max(most, std::abs(beyond_A[coil]) / rig.coils.largest_A(coil));
      CHECK(most == Approx(1.0));
    }
    CHECK(drive.current_A({0.0, 0.0}) == PerCoil{});
  }
}

TEST_CASE("coils of which only one may be on never are together") {
  RigDescription rig = tests::ring_rig(6);
  for (std::size_t coil = 0; coil < 3; ++coil) rig.coils.each[coil].not_with = {rig.coils.name(coil + 3)};
  const CoilDrive drive(rig);
  for (double angle_rad = 0.0; angle_rad < 6.28; angle_rad += 0.037) {
    const PerCoil current_A = drive.current_A(15.0 * along(angle_rad));
    for (std::size_t coil = 0; coil < 3; ++coil) CHECK(current_A[coil] * current_A[coil + 3] == 0.0);
  }
}

TEST_CASE("coils on one side only are refused, with the direction that they lack") {
  RigDescription rig = tests::ring_rig(6);
  rig.coils.each.resize(2);
  CHECK_THROWS_WITH(CoilDrive(rig), Catch::Contains("cannot pull the needle along"));
  rig = tests::ring_rig(6);
  rig.coils.max_current_A = 0.0;
  CHECK_THROWS_WITH(CoilDrive(rig), Catch::Contains("coils.max_current_A = 0"));
}

}  // namespace
}  // namespace lodestone::physics
