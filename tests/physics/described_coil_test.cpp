#include "lodestone/physics/described_coil.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "measured_rig.h"

namespace lodestone::physics {
namespace {

TEST_CASE("a coil that was not measured has the field of its winding") {
  const RigDescription rig = tests::small_ring_rig();
  const DescribedCoil coil(rig.coils.each[2], rig.coils.measured);
  const StandingCoil exact(rig.coils.each[2]);
  CHECK(coil.per_ampere({0.01, 0.02, -0.003}) == exact.per_ampere({0.01, 0.02, -0.003}));
  CHECK(coil.in_plane_per_ampere({0.01, 0.02}) == exact.per_ampere({0.01, 0.02, 0.0}));
}

TEST_CASE("a coil that was measured has the field that was seen, where it was") {
  RigDescription rig = tests::measured_small_ring_rig();
  const DescribedCoil coil(rig.coils.each[2], rig.coils.measured);
  const StandingCoil exact(tests::small_ring_rig().coils.each[2]);
  const Eigen::Vector3d point_m(0.011, -0.007, 0.004);
  CHECK((coil.per_ampere(point_m) - exact.per_ampere(point_m)).norm() <
        0.01 * exact.per_ampere(point_m).norm());
  CHECK_THROWS_WITH(coil.per_ampere({0.0, 0.03, 0.0}), Catch::Contains("y was measured from -"));
  // Tables have rims: there the harmonics go on.
  CHECK((coil.in_plane_per_ampere({0.0, 0.026}) - exact.per_ampere({0.0, 0.026, 0.0})).norm() <
        0.2 * exact.per_ampere({0.0, 0.026, 0.0}).norm());
  rig.coils.each[2].gain = 1.1;
  CHECK(DescribedCoil(rig.coils.each[2], rig.coils.measured)
            .per_ampere(point_m)
            .isApprox(1.1 * coil.per_ampere(point_m)));
}

}  // namespace
}  // namespace lodestone::physics
