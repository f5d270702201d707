#include "lodestone/rig/hidden_deviation.h"
#include "lodestone/geometry/angle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/rig/virtual_rig.h"
#include "measured_rig.h"

namespace lodestone::rig {
namespace {

TEST_CASE("what is hidden keeps to its ranges, and uses them") {
  struct Extent {
    double low = 1e9, high = -1e9;
    void add(double value) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  };
  Extent moment, friction, viscosity, gain, tilt_deg, place_m;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const HiddenDeviation wide = HiddenDeviation::draw(DeviationWidth::kWide, seed);
    moment.add(wide.moment);
    friction.add(wide.friction);
    viscosity.add(wide.viscosity);
    REQUIRE(wide.coils.size() == 4);
    for (const physics::CoilPlacement& coil : wide.coils) {
      gain.add(coil.gain);
      tilt_deg.add(coil.tilt_rad * 180.0 / geometry::kPi);
      place_m.add(coil.offset_m.norm());
    }
  }
  const auto covers = [](const Extent& drawn, double low, double high) {
    return drawn.low >= low && drawn.high <= high && drawn.high - drawn.low > 0.9 * (high - low);
  };
  CHECK(covers(moment, 0.75, 1.6));
  CHECK(covers(friction, 0.6, 1.6));
  CHECK(covers(viscosity, 0.7, 1.4));
  CHECK(covers(gain, 0.92, 1.08));
  CHECK(covers(tilt_deg, -3.0, 3.0));
  CHECK(covers(place_m, 0.0, 3.5e-3));
  const HiddenDeviation lab = HiddenDeviation::draw(DeviationWidth::kLab, 3);
  CHECK(std::abs(lab.moment - 1.0) <= 0.1);
  CHECK(lab.moment == HiddenDeviation::draw(DeviationWidth::kLab, 3).moment);
  CHECK(lab.moment != HiddenDeviation::draw(DeviationWidth::kLab, 4).moment);
  CHECK(HiddenDeviation::draw(DeviationWidth::kNone, 3).coils.empty());
}

TEST_CASE("a far rig differs by more than its gain; the others do not") {
  double lightest = 1e9, heaviest = 0.0, farthest_m = 0.0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const HiddenDeviation far = HiddenDeviation::draw(DeviationWidth::kFar, seed);
    lightest = std::min(lightest, far.weight);
    heaviest = std::max(heaviest, far.weight);
    for (const physics::CoilPlacement& coil : far.coils)
      farthest_m = std::max(farthest_m, coil.offset_m.norm());
    physics::RigDescription described;
    const physics::RigDescription real = far.applied_to(described);
    CHECK(real.needle.net_weight_N == described.needle.net_weight_N * far.weight);
    CHECK(real.friction.rolling_arm_m == described.friction.rolling_arm_m * far.friction);
    CHECK(real.friction.map_correlation_m == described.friction.map_correlation_m * far.map_correlation);
  }
  CHECK((lightest > 0.7 && lightest < 0.72 && heaviest > 1.28 && heaviest < 1.3));
  CHECK((farthest_m > 5e-3 && farthest_m < 6.5e-3));
  const HiddenDeviation wide = HiddenDeviation::draw(DeviationWidth::kWide, 5);
  CHECK((wide.weight == 1.0 && wide.map_sigma == 1.0 && wide.map_correlation == 1.0));
}

TEST_CASE("coils that were measured stand where they were; dish and currents deviate") {
  const physics::RigDescription rig = tests::measured_small_ring_rig();
  const HiddenDeviation wide = HiddenDeviation::draw(DeviationWidth::kWide, 5, rig.coils);
  REQUIRE(wide.coils.size() == 6);
  for (const physics::CoilPlacement& coil : wide.coils) {
    CHECK(coil.tilt_rad == 0.0);
    CHECK(coil.offset_m == wide.coils[0].offset_m);
    CHECK((coil.gain != 1.0 && std::abs(coil.gain - 1.0) <= 0.08));
  }
  CHECK(wide.coils[0].offset_m.norm() > 0.0);
  CHECK(deviation_margin_m(DeviationWidth::kWide, rig) == 1.5e-3);
  CHECK(deviation_margin_m(DeviationWidth::kWide, tests::small_ring_rig()) > 3.5e-3);
  CHECK(wide.friction == HiddenDeviation::draw(DeviationWidth::kWide, 5).friction);
}

TEST_CASE("coils that stand elsewhere make the field that they would make there") {
  const physics::CoilGeometry geometry;
  const auto table = physics::make_field_table(geometry, 0.0425, 9e-3);
  std::vector<physics::CoilPlacement> placements(4);
  const geometry::Vector2 shift_m(1e-3, -2e-3);
  placements[0] = {1.05, 0.0, shift_m};
  placements[2] = {1.0, 0.05, geometry::Vector2::Zero()};
  const physics::CoilArray straight(table);
  const physics::CoilArray moved(table, placements);
  const geometry::Vector2 point_m(0.012, -0.02);
  const geometry::Vector2 shifted = moved.field_T({3.0, 0.0, 0.0, 0.0}, point_m);
  CHECK((shifted - 1.05 * straight.field_T({3.0, 0.0, 0.0, 0.0}, point_m - shift_m)).norm() < 1e-12);
  // Turned about the coil's own middle, so the field there on its axis turns with it.
  const geometry::Vector2 middle_m(0.0, geometry.centre_distance_m);
  const Eigen::Rotation2Dd turn(0.05);
  const geometry::Vector2 seen = moved.field_T({0.0, 0.0, 2.0, 0.0}, middle_m + turn * (point_m - middle_m));
  CHECK((seen - turn * straight.field_T({0.0, 0.0, 2.0, 0.0}, point_m)).norm() < 1e-12);
  // An untouched coil is as it was.
  CHECK((moved.field_T({0.0, 2.0, 0.0, 0.0}, point_m) - straight.field_T({0.0, 2.0, 0.0, 0.0}, point_m))
            .norm() < 1e-15);
}

TEST_CASE("a rig of any width can be driven all over its dish, and widths differ") {
  std::vector<geometry::Pose2> ends;
  for (const DeviationWidth width :
       {DeviationWidth::kNone, DeviationWidth::kLab, DeviationWidth::kWide, DeviationWidth::kFar}) {
    VirtualRigConfig config;
    config.simulation.deviation = width;
    for (const std::uint64_t seed : {1, 2, 3}) {
      VirtualRig rig(config, seed);
      CHECK(rig.config().needle.moment_A_m2 == config.needle.moment_A_m2);  // what is told is the description
      rig.place({0.0, 0.0, 0.3});
      for (int pulse = 0; pulse < 12; ++pulse) {
        CoilPulse drive{{}, 0.1};
        drive.current_A[static_cast<std::size_t>(pulse / 3)] = 15.0;
        rig.coils().apply(drive);
        rig.clock().sleep_until(rig.clock().now_s() + 0.3);
      }
      ends.push_back(rig.true_pose());
      CHECK(rig.true_pose().position_m().norm() < config.dish.radius_m);
    }
  }
  CHECK((ends[0].position_m() - ends[3].position_m()).norm() > 1e-6);
  CHECK((ends[3].position_m() - ends[6].position_m()).norm() > 1e-6);
}

}  // namespace
}  // namespace lodestone::rig
