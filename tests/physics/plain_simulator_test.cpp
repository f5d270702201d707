#include "lodestone/physics/plain_simulator.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "sphere_rig.h"

namespace lodestone::physics {
namespace {

using geometry::Pose2;

TEST_CASE("plain simulator: on-axis force and torque in closed form") {
  const RigDescription rig;
  const PlainSimulator simulator(rig, {});
  const double moment = DipoleCoil(rig.coils.geometry, 0).moment_per_ampere_m2();
  const double d = rig.coils.geometry.centre_distance_m;
  const double field = 1.25663706212e-6 * 2.0 * moment / (4.0 * geometry::kPi * d * d * d);
  const auto aligned = simulator.load({0, 0, 0}, {2.0, 0, 0, 0});
  CHECK(aligned.force_N.x() == Approx(2.0 * rig.needle.moment_A_m2 * 3.0 * field / d));
  CHECK(aligned.force_N.y() == Approx(0.0).margin(1e-15));
  CHECK(simulator.load({0, 0, -geometry::kPi / 2}, {2.0, 0, 0, 0}).torque_N_m ==
        Approx(2.0 * rig.needle.moment_A_m2 * field));
  CHECK(simulator.load({0, 0, geometry::kPi}, {2.0, 0, 0, 0}).force_N.x() < 0.0);
  CHECK(simulator.load({0, 0, geometry::kPi / 2}, {0, 0, 2.0, 0}).force_N.y() > 0.0);
}

TEST_CASE(
    "plain simulator: moves to the coil, turns into the field, rests below break-away, stays in the dish") {
  const PlainSimulator simulator({}, {});
  const Pose2 pulled = simulator.step({0, 0, 0}, {5.0, 0, 0, 0}, 0.1, 0.2);
  CHECK(pulled.x_m > 2e-3);
  CHECK(pulled.y_m == Approx(0.0).margin(1e-12));
  const Pose2 turned = simulator.step({0, 0, 1.0}, {1.0, 0, 0, 0}, 0.1, 0.2);
  CHECK(turned.heading_rad < 0.7);
  const Pose2 held = simulator.step({0, 0, 0}, {0.5, 0, 0, 0}, 0.1, 0.2);
  CHECK(held.x_m == 0.0);
  CHECK(simulator.step({0.01, 0.02, 1.0}, {0, 0, 0, 0}, 0.1, 0.2).x_m == 0.01);
  Pose2 far{0.02, 0.0, 0.0};
  for (int i = 0; i < 5; ++i) far = simulator.step(far, {15.0, 0, 4.0, 0}, 0.1, 0.2);
  CHECK(std::hypot(far.x_m, far.y_m) <= RigDescription{}.dish.radius_m + 1e-12);
}

TEST_CASE("plain simulator: a capsule is pulled and held as a needle is") {
  RigDescription rig;
  rig.needle.length_m = 5e-3;
  rig.needle.diameter_m = 2.2e-3;
  rig.needle.chain_m = 4e-3;
  rig.needle.tape_length_m = 1e-3;
  const PlainSimulator simulator(rig, {});
  CHECK(simulator.step({0, 0, 0}, {5.0, 0, 0, 0}, 0.1, 0.2).x_m > 1e-3);
  CHECK(simulator.step({0, 0, 0}, {0.5, 0, 0, 0}, 0.1, 0.2).x_m == 0.0);
}

TEST_CASE("plain simulator: a sphere is pulled whatever its heading, up the field's strength") {
  const RigDescription rig = tests::sphere_rig();
  const PlainSimulator simulator(rig, {});
  const PerCoil current_A = {4.0, 0.0, 2.0, 0.0};
  const auto pulled = simulator.load({0.01, 0.005, 0.0}, current_A);
  const auto turned = simulator.load({0.01, 0.005, 2.0}, current_A);
  CHECK(pulled.force_N == turned.force_N);
  CHECK(pulled.torque_N_m == 0.0);
  const ModelledField field(rig);
  const double h = 1e-5;
  const auto strength_T = [&](double x_m, double y_m) {
    return field.at(current_A, {x_m, y_m}).field_T.norm();
  };
  CHECK(pulled.force_N.x() == Approx(rig.needle.moment_A_m2 *
                                     (strength_T(0.01 + h, 0.005) - strength_T(0.01 - h, 0.005)) / (2.0 * h))
                                  .epsilon(1e-3));
  const Pose2 moved = simulator.step({0.0, 0.0, 2.0}, {5.0, 0, 0, 0}, 0.1, 0.2);
  CHECK(moved.x_m > 1e-3);
  CHECK(moved.heading_rad == Approx(2.0));
  CHECK(simulator.step({0.0, 0.0, 0.0}, {0.5, 0, 0, 0}, 0.1, 0.2).x_m == 0.0);
}

TEST_CASE("plain simulator: symmetric under a quarter turn") {
  const PlainSimulator simulator({}, {});
  const Pose2 a = simulator.step({0.01, -0.004, 0.4}, {4.0, 0, 0, 6.0}, 0.1, 0.2);
  const Pose2 b = simulator.step({0.004, 0.01, 0.4 + geometry::kPi / 2}, {6.0, 0, 4.0, 0}, 0.1, 0.2);
  CHECK(b.x_m == Approx(-a.y_m).epsilon(1e-9));
  CHECK(b.y_m == Approx(a.x_m).epsilon(1e-9));
}

}  // namespace
}  // namespace lodestone::physics
