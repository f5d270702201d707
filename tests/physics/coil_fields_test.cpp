#include "lodestone/physics/coil_fields.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/standing_coil.h"
#include "measured_rig.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("the paper's coils listed one by one have the field of the four") {
  const RigDescription paper, listed = tests::listed_paper_rig();
  const CoilFields ring(paper.coils, 0.0425), each(listed.coils, 0.0425);
  CHECK(ring.planar());
  CHECK_FALSE(each.planar());
  for (std::size_t coil = 0; coil < 4; ++coil)
    for (const Vector2& point_m : {Vector2(0.0, 0.0), Vector2(0.011, -0.023), Vector2(-0.03, 0.028)}) {
      const Eigen::Vector3d want = ring.per_ampere(coil, point_m);
      CHECK((each.per_ampere(coil, point_m) - want).norm() < 1e-6 * want.norm());
    }
  // Deviations, too: turned and moved likewise.
  std::vector<CoilPlacement> placements(4);
  for (std::size_t coil = 0; coil < 4; ++coil)
    placements[coil] = {1.02, 0.05 - 0.03 * static_cast<double>(coil), {1e-3, -5e-4}};
  const CoilArray four(std::make_shared<const CoilFields>(paper.coils, 0.0425, 9e-3), placements);
  const CoilArray same(std::make_shared<const CoilFields>(listed.coils, 0.0425, 9e-3), placements);
  const PerCoil current_A = {3.0, -1.0, 2.0, 5.0};
  const Vector2 want = four.field_T(current_A, {0.02, 0.01});
  CHECK((same.field_T(current_A, {0.02, 0.01}) - want).norm() < 1e-6 * want.norm());
  CHECK(std::abs(same.spatial_field_T(current_A, {0.02, 0.01}).z()) < 1e-12);
}

TEST_CASE("tables of coils out of the plane hold their exact field") {
  const RigDescription rig = tests::ring_rig(8, 0.03);
  const CoilFields fields(rig.coils, rig.dish.radius_m);
  for (const std::size_t coil : {std::size_t{0}, std::size_t{3}}) {
    const StandingCoil exact(rig.coils.coil(coil));
    for (const Vector2& point_m : {Vector2(0.0, 0.0), Vector2(0.0313, -0.0127), Vector2(-0.0101, 0.0402)}) {
      const Eigen::Vector3d want = exact.per_ampere({point_m.x(), point_m.y(), 0.0});
      CHECK((fields.per_ampere(coil, point_m) - want).norm() < 1e-4 * want.norm());
    }
  }
  CHECK_THROWS_AS(fields.per_ampere(0, {0.06, 0.0}), common::LogicFault);
  CHECK(fields.of(rig.coils));
  CHECK_FALSE(fields.of(tests::ring_rig(8, 0.031).coils));
  CHECK_FALSE(fields.of(CoilsDescription{}));
}

TEST_CASE("measured coils have the field of their windings, over what is there without current") {
  const RigDescription rig = tests::measured_small_ring_rig(), built = tests::small_ring_rig();
  const auto fields = std::make_shared<const CoilFields>(rig.coils, rig.dish.radius_m, 2e-3);
  const CoilFields exact(built.coils, rig.dish.radius_m);
  for (const Vector2& point_m : {Vector2(0.0, 0.0), Vector2(0.013, -0.0127), Vector2(-0.0101, 0.0162)}) {
    for (std::size_t coil = 0; coil < 6; ++coil)
      CHECK((fields->per_ampere(coil, point_m) - exact.per_ampere(coil, point_m)).norm() <
            0.02 * exact.per_ampere(coil, point_m).norm());
    CHECK((fields->background_T(point_m) - Eigen::Vector3d(40e-6, 0.0, 0.0)).norm() < 4e-6);
    CHECK(exact.background_T(point_m).isZero(0.0));
  }
  // It is there whatever the currents are, and whoever asks.
  CHECK((CoilArray(fields).field_T({}, {0.01, 0.0}) - Vector2(40e-6, 0.0)).norm() < 4e-6);
  CHECK(fields->of(rig.coils));
  CHECK_FALSE(fields->of(built.coils));
  RigDescription other = rig;
  other.coils.each[3].harmonics_T_per_A[1] *= 1.01;
  CHECK_FALSE(fields->of(other.coils));
  CHECK_THROWS_WITH(CoilFields(rig.coils, rig.dish.radius_m, 8e-3),
                    Catch::Contains("in the needle's plane, and 28.5 mm are needed") &&
                        Catch::Contains("simulation.deviation"));
}

}  // namespace
}  // namespace lodestone::physics
