#include "lodestone/physics/sphere_motion.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/coil_fields.h"
#include "other_rigs.h"
#include "sphere_rig.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

const CoilArray& sphere_coils() {
  static const CoilArray array(make_field_table(CoilGeometry{}, 0.0425));
  return array;
}

FrictionConfig even_friction() {
  FrictionConfig friction;
  friction.map_sigma = 0.0;
  return friction;
}

FluidConfig no_fluid() {
  FluidConfig fluid;
  fluid.viscosity_Pa_s = 0.0;
  fluid.cross_flow_factor = 0.0;
  return fluid;
}

NeedleState rolling_at(double x_m, double speed_x_m_s) {
  NeedleState state;
  state.pose.x_m = x_m;
  state.velocity_x_m_s = state.roll_x_m_s = speed_x_m_s;
  state.stuck = false;
  return state;
}

TEST_CASE("a sphere far from the floor has Stokes' drag, and more of it beside the floor") {
  const NeedleConfig needle = tests::sphere();
  FluidConfig fluid;
  const double stokes = 3.0 * geometry::kPi * fluid.viscosity_Pa_s * needle.diameter_m;
  fluid.wall_gap_m = 0.1;
  CHECK(sphere_drag(needle, fluid).sliding_N_s_m == Approx(stokes));
  // Turning at the same speed of the surface: 8 pi mu r^3 is 4/3 of 6 pi mu r there.
  CHECK(sphere_drag(needle, fluid).rolling_N_s_m == Approx(7.0 / 3.0 * stokes));
  fluid.wall_gap_m = 10e-6;
  CHECK(sphere_drag(needle, fluid).sliding_N_s_m == Approx(3.631 * stokes).epsilon(1e-3));
  CHECK(sphere_drag(needle, fluid).rolling_N_s_m == Approx(5.981 * stokes).epsilon(1e-3));
}

TEST_CASE("a free moment is pulled as a short needle that lies along the field") {
  NeedleConfig needle = tests::sphere();
  const PerCoil current{6.0, 0.0, 0.0, 4.0};
  for (const Vector2& middle_m : {Vector2(0.0, 0.0), Vector2(0.02, -0.015), Vector2(-0.025, 0.01)}) {
    const FreeMomentPull pull = free_moment_pull(needle, middle_m, sphere_coils(), current);
    const Vector2 field_T = sphere_coils().field_T(current, middle_m);
    CHECK((pull.field_T.head<2>() - field_T).norm() < 1e-12);
    CHECK(pull.lift_N == 0.0);
    NeedleConfig needle_of = needle;
    needle_of.shape = NeedleShape::kNeedle;
    needle_of.chain_m = 2e-4;
    const Wrench wrench = magnetic_wrench(needle_of, middle_m, field_T.normalized(), sphere_coils(), current);
    const Vector2 force_N(wrench.force_x_N, wrench.force_y_N);
    CHECK((pull.force_N - force_N).norm() < 0.01 * force_N.norm());
  }
  CHECK(free_moment_pull(needle, {0.01, 0.0}, sphere_coils(), {}).force_N.isZero(0.0));
}

TEST_CASE("a coil below the plane pulls a free moment down to it") {
  const RigDescription rig = tests::ring_rig(6, 0.03);
  const CoilArray array(CoilFields::shared(rig.coils, rig.dish.radius_m));
  // The dish centre lies on the coil's axis, and the pull with it.
  const FreeMomentPull pull =
      free_moment_pull(tests::sphere(), Vector2::Zero(), array, {5.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  CHECK(pull.force_N.x() > 0.0);
  CHECK(std::abs(pull.force_N.y()) < 1e-3 * pull.force_N.x());
  CHECK(pull.lift_N == Approx(-pull.force_N.x() * 0.03 / 0.09).epsilon(0.02));
}

TEST_CASE("along the field a sphere slides, and rests below break-away") {
  const NeedleConfig needle = tests::sphere();
  const SphereMotion motion(needle, FluidConfig{}, even_friction(), DishConfig{});
  const FrictionMap map(even_friction(), 0.0425, 1);
  const double per_A_N =
      free_moment_pull(needle, Vector2::Zero(), sphere_coils(), {1.0, 0.0, 0.0, 0.0}).force_N.x();
  REQUIRE(per_A_N > 0.0);
  const double breakaway_A = even_friction().static_coefficient * needle.net_weight_N / per_A_N;
  NeedleState state;
  motion.step(state, sphere_coils(), {0.98 * breakaway_A, 0.0, 0.0, 0.0}, map, 1.0, 0.5e-3);
  CHECK(state.stuck);
  CHECK(state.pose.x_m == 0.0);
  for (int i = 0; i < 100; ++i)
    motion.step(state, sphere_coils(), {1.02 * breakaway_A, 0.0, 0.0, 0.0}, map, 1.0, 0.5e-3);
  CHECK_FALSE(state.stuck);
  CHECK(state.pose.x_m > 1e-4);
  CHECK(std::abs(state.pose.y_m) < 1e-9);
  CHECK(state.roll_x_m_s == Approx(0.0).margin(1e-9));  // the field holds the moment
  CHECK(state.pose.heading_rad == 0.0);
}

TEST_CASE("across the field a sphere rolls: what slid gives up momentum to turning") {
  const NeedleConfig needle = tests::sphere();
  const SphereMotion motion(needle, no_fluid(), even_friction(), DishConfig{});
  const FrictionMap map(even_friction(), 0.0425, 1);
  const double rolling_kg = 4.0 * needle.inertia_kg_m2 / (needle.diameter_m * needle.diameter_m);
  const PerCoil weak{0.3, 0.0, 0.0, 0.0};  // holds the moment along x, and does not move the sphere
  NeedleState state;
  state.velocity_x_m_s = 0.05;
  state.velocity_y_m_s = 0.05;
  state.stuck = false;
  motion.step(state, sphere_coils(), weak, map, 1.0, 1e-6);
  CHECK(state.velocity_x_m_s == Approx(0.05).epsilon(1e-3));
  // But for half a step's way aside, where the field is turned by less than a millionth.
  CHECK(state.roll_x_m_s == Approx(0.0).margin(1e-6));
  CHECK(state.velocity_y_m_s == Approx(0.05 * needle.mass_kg / (needle.mass_kg + rolling_kg)).epsilon(1e-3));
  CHECK(state.roll_y_m_s == Approx(state.velocity_y_m_s));
  // Sliding comes to rest much sooner than rolling.
  double slid_s = 0.0;
  for (; std::abs(state.velocity_x_m_s) > 1e-3 && slid_s < 1.0; slid_s += 0.5e-3)
    motion.step(state, sphere_coils(), weak, map, 1.0, 0.5e-3);
  CHECK(slid_s < 0.1);
  CHECK(state.velocity_y_m_s > 0.01);
}

TEST_CASE("without a field a sphere rolls out by what resists rolling") {
  const NeedleConfig needle = tests::sphere();
  const FrictionConfig friction = even_friction();
  const SphereMotion motion(needle, no_fluid(), friction, DishConfig{});
  const FrictionMap map(friction, 0.0425, 1);
  const double radius_m = 0.5 * needle.diameter_m;
  const double slowing_m_s2 = friction.rolling_arm_m / radius_m * needle.net_weight_N /
                              (needle.mass_kg + needle.inertia_kg_m2 / (radius_m * radius_m));
  NeedleState state = rolling_at(-0.02, 0.05);
  for (int i = 0; i < 20; ++i) motion.step(state, sphere_coils(), {}, map, 1.0, 0.5e-3);
  CHECK(state.velocity_x_m_s == Approx(0.05 - 0.01 * slowing_m_s2).epsilon(1e-6));
  for (int i = 0; i < 10000 && !state.stuck; ++i) motion.step(state, sphere_coils(), {}, map, 1.0, 0.5e-3);
  CHECK(state.stuck);
  CHECK(state.velocity_x_m_s == 0.0);
  CHECK(state.pose.x_m + 0.02 == Approx(0.5 * 0.05 * 0.05 / slowing_m_s2).epsilon(0.02));
  // In the fluid it comes less far.
  const SphereMotion wet(needle, FluidConfig{}, friction, DishConfig{});
  NeedleState slower = rolling_at(-0.02, 0.05);
  for (int i = 0; i < 10000 && !slower.stuck; ++i) wet.step(slower, sphere_coils(), {}, map, 1.0, 0.5e-3);
  CHECK(slower.stuck);
  CHECK(slower.pose.x_m < state.pose.x_m - 1e-4);
}

TEST_CASE("the wall stops a sphere a radius before it, inelastically") {
  const NeedleConfig needle = tests::sphere();
  const DishConfig dish;
  const SphereMotion motion(needle, FluidConfig{}, FrictionConfig{}, dish);
  const FrictionMap map(FrictionConfig{}, dish.radius_m, 1);
  const double reach_m = dish.radius_m - 0.5 * needle.diameter_m;
  NeedleState state = rolling_at(0.0, 0.5);
  state.velocity_y_m_s = 0.2;
  for (int i = 0; i < 1000; ++i) {
    motion.step(state, sphere_coils(), {15.0, 0.0, 8.0, 0.0}, map, 1.0, 0.5e-3);
    REQUIRE(motion.fits(state.pose));
  }
  CHECK(state.pose.position_m().norm() == Approx(reach_m).margin(1e-4));
  for (int i = 0; i < 10000 && !state.stuck; ++i) motion.step(state, sphere_coils(), {}, map, 1.0, 0.5e-3);
  CHECK(state.stuck);
  // Straight into the wall: it stays there, no bounce.
  state = rolling_at(0.0395, 0.8);
  for (int i = 0; i < 400; ++i) motion.step(state, sphere_coils(), {}, map, 1.0, 0.5e-3);
  CHECK(state.pose.x_m == Approx(reach_m).margin(1e-6));
  CHECK(state.stuck);
  CHECK(motion.fits({0.0, reach_m - 1e-9, 1.0}));
  CHECK_FALSE(motion.fits({0.0, reach_m + 1e-9, 1.0}));
  CHECK_FALSE(motion.fits({0.0, std::nan(""), 0.0}));
}

TEST_CASE("half the step gives nearly the same motion of a sphere") {
  const FrictionMap map(FrictionConfig{}, 0.0425, 3);
  const SphereMotion motion(tests::sphere(), FluidConfig{}, FrictionConfig{}, DishConfig{});
  const auto pulsed = [&](double step_s) {
    NeedleState state;
    state.pose = {-0.01, 0.004, 0.0};
    const int steps = static_cast<int>(std::lround(0.05 / step_s));
    for (int i = 0; i < steps; ++i)
      motion.step(state, sphere_coils(), {8.0, 0.0, 0.0, 3.0}, map, 1.0, step_s);
    return state.pose.position_m();
  };
  const Vector2 fine_m = pulsed(0.125e-3);
  CHECK((fine_m - Vector2(-0.01, 0.004)).norm() > 5e-4);
  CHECK((pulsed(0.5e-3) - fine_m).norm() < 0.05 * (fine_m - Vector2(-0.01, 0.004)).norm());
}

TEST_CASE("a sphere that is longer than thick is refused") {
  NeedleConfig needle = tests::sphere();
  needle.length_m = 4e-3;
  CHECK_THROWS_AS(SphereMotion(needle, FluidConfig{}, FrictionConfig{}, DishConfig{}), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::physics
