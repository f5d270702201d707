#include "lodestone/physics/coil_drive.h"

#include <catch2/catch.hpp>
#include <cmath>

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
        most = std::max(most, beyond[coil] / rig.coils.largest_A(coil));
      }
      CHECK(most == Approx(1.0));
    }
  CHECK(drive.current_A({0.0, 0.0}, Vector2(0.0, 0.0)) == PerCoil{});
}

}  // namespace
}  // namespace lodestone::physics
