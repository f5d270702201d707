#include "lodestone/physics/needle_motion.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "lodestone/geometry/angle.h"
#include "physics/moving_needle.h"

namespace lodestone::physics {
namespace {

using geometry::Pose2;
using geometry::Vector2;
using tests::kinetic_energy;
using tests::moving;
using tests::paper_coils;
using tests::smooth_friction;

FrictionConfig no_friction() {
  FrictionConfig none = smooth_friction();
  none.static_coefficient = none.kinetic_coefficient = 0.0;
  return none;
}

FluidConfig no_drag() {
  FluidConfig dry;
  dry.viscosity_Pa_s = 0.0;
  dry.cross_flow_factor = 0.0;
  return dry;
}

/// Drag a thousand times that of the rig's fluid: a needle follows its load and the flow at once.
FluidConfig syrup() {
  FluidConfig thick;
  thick.viscosity_Pa_s *= 1000.0;
  thick.cross_flow_factor = 0.0;
  return thick;
}

Flow uniform_flow(double speed_m_s, double direction_deg) {
  FlowConfig config;
  config.kind = FlowKind::kUniform;
  config.speed_m_s = speed_m_s;
  config.direction_deg = direction_deg;
  return Flow(config);
}

ObstacleConfig round_obstacle(double x_m, double y_m, double radius_m) {
  ObstacleConfig config;
  config.centre_m = {x_m, y_m};
  config.radius_m = radius_m;
  return config;
}

ObstacleConfig cornered_obstacle(const std::vector<double>& corners_m) {
  ObstacleConfig config;
  config.shape = ObstacleShape::kPolygon;
  config.corners_m = corners_m;
  return config;
}

TEST_CASE("a free needle drifts with the flow, as fast as the flow") {
  const NeedleMotion motion(NeedleConfig{}, FluidConfig{}, no_friction(), DishConfig{},
                            uniform_flow(5e-3, 30.0));
  const FrictionMap map(no_friction(), 0.0425, 1);
  NeedleState state;
  state.pose = {-0.015, -0.008, 0.9};
  for (int i = 0; i < 4000; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3, 0.5e-3 * i);
  CHECK(state.velocity_x_m_s == Approx(5e-3 * std::cos(geometry::kPi / 6.0)).epsilon(1e-6));
  CHECK(state.velocity_y_m_s == Approx(2.5e-3).epsilon(1e-6));
  CHECK(state.pose.heading_rad == Approx(0.9).margin(1e-9));
  const Vector2 from_m = state.pose.position_m();
  for (int i = 4000; i < 6000; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3, 0.5e-3 * i);
  CHECK((state.pose.position_m() - from_m).norm() == Approx(5e-3).epsilon(1e-6));
}

TEST_CASE("a needle that is pulled has its terminal speed relative to the fluid") {
  const NeedleConfig needle;
  const RodDrag drag = rod_drag(needle, syrup());
  const FrictionMap map(no_friction(), 0.0425, 1);
  const PerCoil current{5.0, 0.0, 0.0, 0.0};
  for (const double along_m_s : {0.0, 2e-3, -2e-3}) {
    const Flow flow = uniform_flow(std::abs(along_m_s), along_m_s < 0.0 ? 180.0 : 0.0);
    const NeedleMotion motion(needle, syrup(), no_friction(), DishConfig{}, flow);
    NeedleState state;
    for (int i = 0; i < 40; ++i) motion.step(state, paper_coils(), current, map, 1.0, 0.5e-3, 0.5e-3 * i);
    const double terminal_m_s =
        magnetic_wrench(needle, state.pose, paper_coils(), current).force_x_N / drag.along_N_s_m;
    REQUIRE(terminal_m_s > 1e-4);
    CHECK(state.velocity_x_m_s - along_m_s == Approx(terminal_m_s).epsilon(1e-3));
  }
}

TEST_CASE("across the flow a needle has the cross-flow drag of its speed relative to the fluid") {
  const NeedleConfig needle;
  const FluidConfig fluid;
  const FrictionMap map(no_friction(), 0.0425, 1);
  const auto speed_up_m_s = [&](double needle_m_s, double fluid_m_s) {
    const Flow flow = uniform_flow(std::abs(fluid_m_s), fluid_m_s < 0.0 ? -90.0 : 90.0);
    const NeedleMotion motion(needle, fluid, no_friction(), DishConfig{}, flow);
    NeedleState state = moving(0.0, needle_m_s, 0.0);
    motion.step(state, paper_coils(), {}, map, 1.0, 1e-6);
    return state.velocity_y_m_s - needle_m_s;
  };
  // Only the difference counts.
  const double change_m_s = speed_up_m_s(0.0, 0.05);
  REQUIRE(change_m_s > 0.0);
  CHECK(speed_up_m_s(-0.02, 0.03) == Approx(change_m_s).epsilon(1e-6));
  CHECK(speed_up_m_s(0.01, 0.06) == Approx(change_m_s).epsilon(1e-6));
  CHECK(speed_up_m_s(0.02, -0.03) == Approx(-change_m_s).epsilon(1e-6));
  CHECK(speed_up_m_s(0.04, 0.04) == Approx(0.0).margin(1e-12));
  // White's drag of a cylinder beside the viscous drag.
  const double re = fluid.density_kg_m3 * 0.05 * needle.diameter_m / fluid.viscosity_Pa_s;
  const double cross_N = 0.5 * fluid.density_kg_m3 * needle.diameter_m * needle.length_m * 0.05 * 0.05 *
                         (1.0 + 10.0 * std::pow(re, -2.0 / 3.0));
  const double force_N = rod_drag(needle, fluid).across_N_s_m * 0.05 + cross_N;
  CHECK(change_m_s == Approx(1e-6 * force_N / needle.mass_kg).epsilon(1e-3));
}

TEST_CASE("friction holds a needle against a weak flow, and lets a strong one carry it") {
  const NeedleConfig needle;
  const FrictionConfig friction = smooth_friction();
  const FrictionMap map(friction, 0.0425, 1);
  const double limit_m_s = friction.static_coefficient * needle.net_weight_N /
                           rod_drag(needle, FluidConfig{}).along_N_s_m;  // along the needle
  for (const double share : {0.98, 1.02}) {
    const NeedleMotion motion(needle, FluidConfig{}, friction, DishConfig{},
                              uniform_flow(share * limit_m_s, 0.0));
    CHECK(motion.fluid_moves());
    NeedleState state;
    state.pose.x_m = -0.01;
    for (int i = 0; i < 100; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3, 0.5e-3 * i);
    CHECK(state.stuck == (share < 1.0));
    CHECK((state.pose.x_m > -0.01) == (share > 1.0));
  }
}

TEST_CASE("what differs along the needle turns it: at once in a vortex, by the slope in a channel") {
  const NeedleConfig needle;
  const FrictionMap map(no_friction(), 0.0425, 1);
  FlowConfig config;
  config.kind = FlowKind::kVortex;
  config.core_radius_m = 0.5;  // turns as a solid body where the needle is
  config.circulation_m2_s = 2.0 * geometry::kPi * 0.25 * 1.5;
  const NeedleMotion turning(needle, FluidConfig{}, no_friction(), DishConfig{}, Flow(config));
  NeedleState state;
  state.pose.heading_rad = 0.4;
  for (int i = 0; i < 2000; ++i) turning.step(state, paper_coils(), {}, map, 1.0, 0.5e-3, 0.5e-3 * i);
  CHECK(state.spin_rad_s == Approx(1.5).epsilon(1e-3));
  CHECK(state.pose.position_m().norm() < 1e-6);

  config = FlowConfig{};
  config.kind = FlowKind::kChannel;
  config.speed_m_s = 0.01;
  config.width_m = 0.06;
  const NeedleMotion sheared(needle, syrup(), no_friction(), DishConfig{}, Flow(config));
  state = NeedleState{};
  state.pose = {0.0, 0.01, geometry::kPi / 2.0};
  for (int i = 0; i < 20; ++i) sheared.step(state, paper_coils(), {}, map, 1.0, 1e-4, 1e-4 * i);
  CHECK(state.spin_rad_s == Approx(8.0 * 0.01 * 0.01 / (0.06 * 0.06)).epsilon(1e-3));
  // The mean of the parabola over the needle.
  const double mean_square_m2 = 0.01 * 0.01 + needle.length_m * needle.length_m / 12.0;
  CHECK(state.velocity_x_m_s == Approx(0.01 * (1.0 - 4.0 * mean_square_m2 / (0.06 * 0.06))).epsilon(3e-3));
  CHECK(std::abs(state.velocity_y_m_s) < 1e-5);
}

TEST_CASE("a needle in a thick fluid follows a pulse by the time that it is told") {
  FlowConfig config;
  config.kind = FlowKind::kUniform;
  config.speed_m_s = 2e-3;
  config.waveform = FlowWaveform::kSine;
  config.period_s = 0.4;
  const NeedleMotion motion(NeedleConfig{}, syrup(), no_friction(), DishConfig{}, Flow(config));
  const FrictionMap map(no_friction(), 0.0425, 1);
  for (const auto& [time_s, factor] : {std::pair(0.1, 2.0), std::pair(0.2, 1.0), std::pair(0.3, 0.0)}) {
    NeedleState state;
    constexpr double kStep_s = 1e-4;
    for (int i = 0; i < 40; ++i)
      motion.step(state, paper_coils(), {}, map, 1.0, kStep_s, time_s + kStep_s * (i - 39.5));
    CHECK(state.velocity_x_m_s == Approx(factor * 2e-3).margin(0.01 * 2e-3));
  }
}

TEST_CASE(
    "a motion without flow, with an obstacle that is never reached, is bitwise the motion without either") {
  FlowConfig none;
  none.speed_m_s = 0.1;
  const NeedleMotion plain(NeedleConfig{}, FluidConfig{}, FrictionConfig{}, DishConfig{});
  const NeedleMotion same(NeedleConfig{}, FluidConfig{}, FrictionConfig{}, DishConfig{}, Flow(none),
                          Obstacles({round_obstacle(-0.03, -0.02, 2e-3)}));
  CHECK_FALSE(same.fluid_moves());
  const FrictionMap map(FrictionConfig{}, 0.0425, 3);
  NeedleState a, b;
  a.pose = b.pose = {0.0, 0.01, 1.1};
  for (int i = 0; i < 400; ++i) {
    const PerCoil current{i < 200 ? 9.0 : 0.0, 0.0, i < 200 ? 5.0 : 0.0, 0.0};
    plain.step(a, paper_coils(), current, map, 1.0, 0.5e-3);
    same.step(b, paper_coils(), current, map, 1.0, 0.5e-3, 0.5e-3 * i);
    REQUIRE(std::memcmp(&a.pose, &b.pose, sizeof(a.pose)) == 0);
    REQUIRE((a.velocity_x_m_s == b.velocity_x_m_s && a.velocity_y_m_s == b.velocity_y_m_s));
    REQUIRE(a.spin_rad_s == b.spin_rad_s);
    REQUIRE(a.stuck == b.stuck);
  }
  CHECK((a.pose.position_m() - Vector2(0.0, 0.01)).norm() > 1e-3);
}

TEST_CASE("an obstacle stops a needle that comes straight at it, where they touch") {
  const NeedleConfig needle;
  const double half_m = needle.length_m / 2.0;
  for (const ObstacleConfig& obstacle :
       {round_obstacle(0.03, 0.0, 5e-3),
        cornered_obstacle({0.025, -0.005, 0.03, -0.005, 0.03, 0.005, 0.025, 0.005})}) {
    const NeedleMotion motion(needle, no_drag(), no_friction(), DishConfig{}, Flow(), Obstacles({obstacle}));
    const FrictionMap map(no_friction(), 0.0425, 1);
    NeedleState state = moving(0.5, 0.0, 0.0);
    for (int i = 0; i < 100; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3);
    CHECK(state.pose.x_m == Approx(0.025 - half_m).margin(1e-7));
    CHECK(std::abs(state.velocity_x_m_s) < 1e-6);
    CHECK(motion.free_at(state.pose));
    CHECK_FALSE(motion.free_at({0.025 - half_m + 1e-6, 0.0, 0.0}));
  }
}

TEST_CASE("obstacles are never entered, and give no energy") {
  const NeedleConfig needle;
  const Obstacles obstacles({round_obstacle(0.014, 0.004, 4e-3), round_obstacle(-0.02, 0.02, 3e-3),
                             cornered_obstacle({-0.015, -0.02, 0.0, -0.01, 0.012, -0.022}),
                             cornered_obstacle({-0.02, 0.0, -0.01, 0.002, -0.02, 0.006, -0.017, 0.003})});
  for (const double friction : {0.0, 0.2, 1.0}) {
    DishConfig dish;
    dish.wall_friction = friction;
    const NeedleMotion motion(needle, no_drag(), no_friction(), dish, Flow(), obstacles);
    const FrictionMap map(no_friction(), 0.0425, 1);
    int runs = 0, hits = 0;
    for (const double heading : {0.0, 0.8, 1.6, 2.4}) {
      for (const double spin : {0.0, 25.0, -25.0}) {
        for (const double angle : {0.3, 1.4, 2.7, 3.9, 5.2}) {
          NeedleState state = moving(0.3 * std::cos(angle), 0.3 * std::sin(angle), spin);
          state.pose = {0.0, 0.012, heading};
          if (!motion.free_at(state.pose)) continue;
          ++runs;
          const double start = kinetic_energy(needle, state);
          double energy = start, gained = 0.0;
          for (int i = 0; i < 300; ++i) {
            motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3);
            REQUIRE(motion.free_at(state.pose));
            const double now = kinetic_energy(needle, state);
            gained += std::max(0.0, now - energy);
            energy = now;
          }
          CAPTURE(friction, heading, spin, angle, gained / start);
          CHECK(gained <= (friction > 0.0 ? 1e-3 : 1e-9) * start);
          if (energy < 0.9 * start) ++hits;
        }
      }
    }
    CHECK(runs > 20);
    CHECK(hits > runs / 2);
  }
}

TEST_CASE("a needle that slides along an obstacle has the friction of the wall") {
  const NeedleConfig needle;
  const ObstacleConfig long_one = cornered_obstacle({-0.03, -0.02, 0.03, -0.02, 0.03, -0.01, -0.03, -0.01});
  const FrictionMap map(no_friction(), 0.0425, 1);
  for (const double friction : {0.0, 0.2}) {
    DishConfig dish;
    dish.wall_friction = friction;
    const NeedleMotion motion(needle, no_drag(), no_friction(), dish, Flow(), Obstacles({long_one}));
    NeedleState state = moving(0.2, -0.1, 0.0);
    state.pose = {-0.01, -0.01 + needle.diameter_m / 2.0 + 1.03e-3, 0.0};
    for (int i = 0; i < 60; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3);
    // Coulomb's law on the impulse that took all of the motion towards the obstacle.
    CHECK(state.velocity_x_m_s == Approx(0.2 - friction * 0.1).epsilon(0.01));
    CHECK(std::abs(state.velocity_y_m_s) < 1e-5);
    CHECK(std::abs(state.spin_rad_s) < 1e-3);
    CHECK(state.pose.y_m == Approx(-0.01 + needle.diameter_m / 2.0).margin(1e-6));
  }
}

TEST_CASE("a needle between obstacles under a strong pull stays clear of them") {
  const Obstacles obstacles({round_obstacle(0.015, 0.0035, 3e-3), round_obstacle(0.015, -0.0032, 2.7e-3),
                             cornered_obstacle({0.0, 0.006, 0.008, 0.003, 0.008, 0.009})});
  const NeedleMotion motion(NeedleConfig{}, FluidConfig{}, FrictionConfig{}, DishConfig{},
                            uniform_flow(0.05, 20.0), obstacles);
  const FrictionMap map(FrictionConfig{}, 0.0425, 2);
  for (const double heading : {0.0, 0.5, 3.0}) {
    NeedleState state;
    state.pose = {-0.012, -0.002, heading};
    REQUIRE(motion.free_at(state.pose));
    for (int i = 0; i < 1000; ++i) {
      const double turn = 0.02 * i;
      const PerCoil current{10.0 + 5.0 * std::cos(turn), 0.0, 4.0 + 4.0 * std::sin(turn), 0.0};
      motion.step(state, paper_coils(), current, map, 1.0, 0.5e-3, 0.5e-3 * i);
      REQUIRE(motion.free_at(state.pose));
    }
    CHECK((state.pose.position_m() - Vector2(-0.012, -0.002)).norm() > 2e-3);
  }
}

TEST_CASE("a needle that would lie in an obstacle finds the nearest free place, always the same") {
  const auto with = [](const std::vector<ObstacleConfig>& obstacles) {
    return NeedleMotion(NeedleConfig{}, FluidConfig{}, FrictionConfig{}, DishConfig{}, Flow(),
                        Obstacles(obstacles));
  };
  const NeedleMotion motion = with({round_obstacle(0.0, 0.0, 5e-3)});
  CHECK_FALSE(motion.free_at({0.0, 0.0, 0.0}));
  CHECK(motion.fits({0.0, 0.0, 0.0}));
  const auto place = motion.free_near({0.0, 0.0, 0.0});
  REQUIRE(place.has_value());
  CHECK(motion.free_at(*place));
  CHECK(place->heading_rad == 0.0);
  CHECK(place->position_m().norm() == Approx(6e-3));  // in rings of a millimetre
  CHECK(motion.free_near({0.0, 0.0, 0.0})->x_m == place->x_m);
  const Pose2 free{0.0, 0.02, 0.3};
  CHECK(motion.free_near(free)->y_m == free.y_m);
  CHECK(motion.free_near(free)->heading_rad == free.heading_rad);
  CHECK_FALSE(with({round_obstacle(0.0, 0.0, 0.041)}).free_near({0.0, 0.0, 0.0}).has_value());
}

}  // namespace
}  // namespace lodestone::physics
