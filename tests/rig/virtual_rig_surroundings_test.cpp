#include "lodestone/rig/virtual_rig.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "rig/described_rig.h"
#include "rig/smooth_rig.h"
#include "rig/step_clock.h"
#include "sphere_rig.h"

namespace lodestone::rig {
namespace {

using geometry::Pose2;
using tests::random_pulse;
using tests::same_bits;
using tests::shared_fields;
using tests::smooth;
using tests::StepClock;

physics::ObstacleConfig round_body(double x_m, double y_m, double radius_m) {
  physics::ObstacleConfig obstacle;
  obstacle.centre_m = {x_m, y_m};
  obstacle.radius_m = radius_m;
  return obstacle;
}

/// Without friction, in fluid that pulses along +x.
VirtualRigConfig pulsing() {
  VirtualRigConfig config = smooth();
  config.friction.static_coefficient = config.friction.kinetic_coefficient = 0.0;
  config.simulation.flow.kind = physics::FlowKind::kUniform;
  config.simulation.flow.speed_m_s = 5e-3;
  config.simulation.flow.waveform = physics::FlowWaveform::kSine;
  config.simulation.flow.period_s = 0.7;
  return config;
}

TEST_CASE("a rig that is told of no flow and no obstacle is bitwise the rig that is told nothing") {
  VirtualRigConfig told = tests::described_rig();
  told.simulation.flow.kind = physics::FlowKind::kNone;
  told.simulation.flow.speed_m_s = 0.1;
  told.simulation.flow.waveform = physics::FlowWaveform::kSine;
  told.simulation.obstacles = {};
  VirtualRig rig(tests::described_rig(), 4, shared_fields()), other(told, 4, shared_fields());
  for (VirtualRig* each : {&rig, &other}) {
    common::RandomStream random(9, "test");
    for (int i = 0; i < 4; ++i) {
      each->coils().apply(random_pulse(random));
      each->clock().sleep_until(each->clock().now_s() + 0.3);
    }
  }
  CHECK(rig.save() == other.save());
  CHECK(rig.true_pose().position_m().norm() > 1e-3);
}

TEST_CASE("fluid that moves carries a needle that nothing drives, by the rig's clock") {
  const VirtualRigConfig config = pulsing();
  VirtualRig rig(config, 1, shared_fields());
  rig.place({-0.012, 0.0, 0.0});
  rig.clock().sleep_until(1.3);
  const common::Json saved = common::Json::parse(rig.save().dump());
  rig.clock().sleep_until(2.0);
  // Without friction: momentum lost to the fluid is drag times the way relative to it.
  const double drag_N_s_m = physics::rod_drag(config.needle, config.fluid).along_N_s_m;
  const double omega = 2.0 * geometry::kPi / 0.7;
  const double fluid_way_m = 5e-3 * (2.0 + (1.0 - std::cos(omega * 2.0)) / omega);
  const double speed_m_s = rig.save()["velocity"][0].get<double>();
  CHECK(rig.true_pose().x_m ==
        Approx(-0.012 + fluid_way_m - config.needle.mass_kg / drag_N_s_m * speed_m_s).margin(2e-5));
  CHECK(std::abs(rig.true_pose().y_m) < 1e-9);

  VirtualRig resumed(config, 1, shared_fields());
  resumed.restore(saved);
  resumed.clock().sleep_until(2.0);
  CHECK(resumed.save() == rig.save());

  VirtualRig paced(config, 1, shared_fields());
  StepClock wall;
  paced.keep_pace_with(wall);
  paced.place({-0.012, 0.0, 0.0});
  paced.clock().sleep_until(1.3);
  paced.clock().sleep_until(2.0);
  CHECK(paced.save() == rig.save());
}

TEST_CASE("friction holds a needle against a weak flow") {
  VirtualRigConfig config = pulsing();
  config.friction = smooth().friction;
  VirtualRig rig(config, 1, shared_fields());
  rig.clock().sleep_until(1.0);
  CHECK(rig.at_rest());
  CHECK(rig.true_pose().position_m().norm() == 0.0);
}

TEST_CASE("an obstacle stops a needle that a coil pulls") {
  const auto pulled_to_m = [](bool with_obstacle) {
    VirtualRigConfig config = smooth();
    if (with_obstacle) config.simulation.obstacles = {round_body(0.02, 0.0, 4e-3)};
    VirtualRig rig(config, 1, shared_fields());
    rig.place({-0.005, 0.0, 0.0});
    rig.coils().apply({{8.0, 0.0, 0.0, 0.0}, 0.1});
    double farthest_m = -0.005;
    for (int i = 1; i <= 60; ++i) {
      rig.clock().sleep_until(0.005 * i);
      farthest_m = std::max(farthest_m, rig.true_pose().x_m);
    }
    return farthest_m;
  };
  const double stopped_m = 0.02 - 4e-3 - 0.5 * physics::NeedleConfig{}.length_m;
  CHECK(pulled_to_m(false) > stopped_m + 1e-3);
  CHECK(pulled_to_m(true) == Approx(stopped_m).margin(1e-5));
}

TEST_CASE("a needle that would be put into an obstacle is put beside it") {
  VirtualRigConfig config = smooth();
  config.simulation.obstacles = {round_body(0.0, 0.0, 4e-3)};
  VirtualRig rig(config, 1, shared_fields()), other(config, 1, shared_fields());
  const double away_m = 4e-3 + 0.5 * config.needle.diameter_m;
  CHECK(rig.true_pose().position_m().norm() >= away_m);  // it would lie at the centre
  CHECK(same_bits(rig.true_pose(), other.true_pose()));
  rig.place({0.001, 0.002, 0.4});
  CHECK(rig.true_pose().heading_rad == Approx(0.4));
  CHECK((rig.true_pose().position_m() - geometry::Vector2(0.001, 0.002)).norm() < 1e-2);
  other.place({0.001, 0.002, 0.4});
  CHECK(same_bits(rig.true_pose(), other.true_pose()));
  rig.place({0.0, 0.02, 0.4});
  CHECK(same_bits(rig.true_pose(), {0.0, 0.02, 0.4}));
  CHECK(rig.fits({0.0, 0.0, 0.0}));  // of obstacles it does not tell
  CHECK_THROWS_AS(rig.place({0.04, 0.0, 0.0}), common::DataError);
  CHECK_THROWS_WITH(rig.restore(VirtualRig(smooth(), 1, shared_fields()).save()),
                    Catch::Contains("lies in an obstacle"));
  config.simulation.obstacles = {round_body(0.0, 0.0, 0.041)};
  CHECK_THROWS_WITH(VirtualRig(config, 1, shared_fields()), Catch::Contains("leave no place in the dish"));
}

TEST_CASE("obstacles out of the dish are refused, and keys come back as they were written") {
  const auto read = [](const std::string& obstacles) {
    return common::config_from_json<VirtualRigConfig>(
        common::Json::parse("{\"simulation\": {\"obstacles\": [" + obstacles + "]}}"), "test");
  };
  CHECK_THROWS_WITH(
      read(R"({}, {"centre_m": [0.04, 0.0], "radius_m": 0.005})"),
      Catch::Contains("simulation.obstacles[1].centre_m = [0.04,0.0] must keep the obstacle inside"));
  CHECK_THROWS_WITH(read(R"({"shape": "polygon", "corners_m": [0.0, 0.0, 0.05, 0.0, 0.0, 0.01]})"),
                    Catch::Contains("simulation.obstacles[0].corners_m") && Catch::Contains("dish.radius_m"));
  CHECK_THROWS_WITH(
      read(R"({"shape": "polygon", "corners_m": [0.0, 0.0, 0.01, 0.0]})"),
      Catch::Contains("simulation.obstacles[0].corners_m") && Catch::Contains("3 to 1000 corners"));
  CHECK_THROWS_AS(read(R"({"radius_m": -0.001})"), common::ConfigError);
  VirtualRigConfig config = pulsing();
  config.simulation.obstacles =
      read(
          R"({"centre_m": [0.01, 0.0]}, {"shape": "polygon", "corners_m": [0.0, 0.0, 0.01, 0.0, 0.0, 0.01]})")
          .simulation.obstacles;
  REQUIRE(config.simulation.obstacles.size() == 2);
  const common::Json written = common::config_to_json(config);
  CHECK(common::config_to_json(common::config_from_json<VirtualRigConfig>(written, "test")) == written);
}

TEST_CASE("a sphere in moving fluid, or among obstacles, is refused") {
  VirtualRigConfig config = smooth();
  config.needle = tests::sphere();
  CHECK_NOTHROW(config.validate());
  config.simulation.flow.kind = physics::FlowKind::kUniform;
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("a sphere is simulated in fluid at rest"));
  config.simulation.flow.kind = physics::FlowKind::kNone;
  config.simulation.obstacles.emplace_back();
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("a sphere is simulated in fluid at rest"));
}

}  // namespace
}  // namespace lodestone::rig
