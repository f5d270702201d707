#include "lodestone/physics/needle.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/field_table.h"
#include "lodestone/physics/needle_motion.h"
#include "physics/moving_needle.h"
#include "sphere_rig.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("a needle is pulled along its axis, turned by a field across it, and neither without current") {
  const NeedleConfig needle;
  const CoilArray coils(make_field_table(CoilGeometry{}, 0.0425));
  const PerCoil towards_x = {10.0, 0.0, 0.0, 0.0};
  const Wrench along = magnetic_wrench(needle, {0.0, 0.0, 0.0}, coils, towards_x);
  CHECK(along.force_x_N > 0.0);
  CHECK(std::abs(along.force_y_N) < 1e-9 * along.force_x_N);
  CHECK(std::abs(along.torque_N_m) < 1e-15);
  const Wrench across = magnetic_wrench(needle, {0.0, 0.0, geometry::kPi / 2.0}, coils, towards_x);
  const double field_T = coils.field_T(towards_x, {0.0, 0.0}).x();
  CHECK(across.torque_N_m ==
        Approx(-needle.moment_A_m2 * field_T).epsilon(0.05));  // clockwise, into the field
  const Wrench none = magnetic_wrench(needle, {0.01, 0.0, 1.0}, coils, {});
  CHECK(none.force_x_N == 0.0);
  CHECK(none.torque_N_m == 0.0);
}

TEST_CASE("drag grows with viscosity and is larger across the needle than along it") {
  const NeedleConfig needle;
  FluidConfig fluid;
  const RodDrag thin = rod_drag(needle, fluid);
  CHECK(thin.across_N_s_m == Approx(2.0 * thin.along_N_s_m));  // beside a wall
  fluid.viscosity_Pa_s *= 3.0;
  CHECK(rod_drag(needle, fluid).rotation_N_m_s == Approx(3.0 * thin.rotation_N_m_s));
  fluid.wall_gap_m = 0.1;  // the free rod's drag is the least there can be
  CHECK(rod_drag(needle, fluid).across_N_s_m < 3.0 * thin.across_N_s_m);
}

TEST_CASE(
    "fluid that flows across a needle sets it in motion at the speed at which its drag is what friction "
    "holds") {
  const NeedleConfig needle;
  const FluidConfig fluid;
  const FrictionConfig friction = tests::smooth_friction();
  const double holds_N = friction.static_coefficient * needle.net_weight_N;
  const double speed_m_s = broadside_speed_m_s(needle, fluid, holds_N);
  CHECK(broadside_drag_N(needle, fluid, speed_m_s) == Approx(holds_N));
  CHECK(speed_m_s > broadside_speed_m_s(needle, fluid, 0.5 * holds_N));
  const auto moves = [&](double factor) {
    FlowConfig flow;
    flow.kind = FlowKind::kUniform;
    flow.speed_m_s = factor * speed_m_s;
    const NeedleMotion motion(needle, fluid, friction, DishConfig{}, Flow(flow));
    NeedleState state;
    state.pose.heading_rad = 0.5 * geometry::kPi;
    motion.step(state, tests::paper_coils(), {}, FrictionMap(friction, 0.0425, 1), 1.0, 1e-4);
    return !state.stuck;
  };
  CHECK_FALSE(moves(0.99));
  CHECK(moves(1.01));
}

TEST_CASE("magnets that are longer than their needle are refused") {
  NeedleConfig needle;
  needle.chain_m = 1.1 * needle.length_m;
  CHECK_THROWS_WITH(needle.validate(), Catch::Contains("chain_m"));
  needle = {};
  needle.diameter_m = 1.1 * needle.length_m;
  CHECK_THROWS_WITH(needle.validate(),
                    Catch::Contains("diameter_m = 0.02585 must not exceed length_m = 0.0235"));
  needle.diameter_m = needle.length_m;
  CHECK_NOTHROW(needle.validate());
  CHECK(rod_drag(needle, {}).rotation_N_m_s > 0.0);
}

TEST_CASE("a sphere is as long as thick") {
  CHECK_FALSE(NeedleConfig{}.is_sphere());
  NeedleConfig needle = tests::sphere();
  CHECK(needle.is_sphere());
  CHECK_NOTHROW(needle.validate());
  needle.length_m = 4e-3;
  CHECK_THROWS_WITH(needle.validate(),
                    Catch::Contains("length_m = 0.004 must be diameter_m = 0.003, for shape is sphere"));
}

}  // namespace
}  // namespace lodestone::physics
