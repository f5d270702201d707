#include "lodestone/physics/needle_motion.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/four_coils.h"
#include "physics/moving_needle.h"

namespace lodestone::physics {
namespace {

using geometry::Pose2;
using geometry::Vector2;
using tests::kinetic_energy;
using tests::moving;
using tests::paper_coils;
using tests::smooth_friction;

/// Interaction energy of the two poles: -pole times the line integral of B from tail to head.
double magnetic_energy(const NeedleConfig& needle, const Pose2& pose, const PerCoil& current) {
  const Vector2 axis(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  constexpr int kPieces = 400;
  double integral = 0.0;
  for (int i = 0; i < kPieces; ++i) {
    const double s = needle.chain_m * ((i + 0.5) / kPieces - 0.5);
    integral +=
        paper_coils().field_T(current, pose.position_m() + s * axis).dot(axis) * needle.chain_m / kPieces;
  }
  return -needle.moment_A_m2 / needle.chain_m * integral;
}

TEST_CASE("a needle along the field is pulled to the coil, and turns into the field") {
  const NeedleConfig needle;
  for (int coil = 0; coil < kFourCoils; ++coil) {
    PerCoil current{};
    current[static_cast<std::size_t>(coil)] = 5.0;
    const Vector2 direction = coil_direction(coil);
    const double towards = std::atan2(direction.y(), direction.x());
    const Wrench aligned = magnetic_wrench(needle, {0.0, 0.0, towards}, paper_coils(), current);
    CHECK(aligned.force_x_N * direction.x() + aligned.force_y_N * direction.y() > 1e-4);
    CHECK(std::abs(aligned.torque_N_m) < 1e-12);
    CHECK(magnetic_wrench(needle, {0.0, 0.0, towards - 0.5}, paper_coils(), current).torque_N_m > 1e-6);
    CHECK(magnetic_wrench(needle, {0.0, 0.0, towards + 0.5}, paper_coils(), current).torque_N_m < -1e-6);
    // With its tail ahead it is pushed away.
    const Wrench reversed =
        magnetic_wrench(needle, {0.0, 0.0, towards + geometry::kPi}, paper_coils(), current);
    CHECK(reversed.force_x_N * direction.x() + reversed.force_y_N * direction.y() < -1e-4);
  }
}

TEST_CASE("force and torque are the gradient of the magnetic energy") {
  const NeedleConfig needle;
  const PerCoil current{6.0, 0.0, 0.0, 4.0};
  for (const Pose2& pose : {Pose2{0.0, 0.0, 0.3}, Pose2{0.02, -0.015, 2.0}, Pose2{-0.025, 0.01, -1.1}}) {
    const Wrench wrench = magnetic_wrench(needle, pose, paper_coils(), current);
    const double h = 1e-5;
    const auto slope = [&](double dx, double dy, double dt) {
      return -(magnetic_energy(needle, {pose.x_m + dx, pose.y_m + dy, pose.heading_rad + dt}, current) -
               magnetic_energy(needle, {pose.x_m - dx, pose.y_m - dy, pose.heading_rad - dt}, current)) /
             (2.0 * h);
    };
    const double force = std::hypot(wrench.force_x_N, wrench.force_y_N);
    CHECK(std::abs(slope(h, 0, 0) - wrench.force_x_N) < 1e-3 * force);
    CHECK(std::abs(slope(0, h, 0) - wrench.force_y_N) < 1e-3 * force);
    CHECK(slope(0, 0, h) == Approx(wrench.torque_N_m).epsilon(1e-3));
  }
}

TEST_CASE("drag beside the dish is that of the design notes") {
  const RodDrag drag = rod_drag(NeedleConfig{}, FluidConfig{});
  CHECK(drag.along_N_s_m == Approx(1.0e-3).epsilon(0.06));
  CHECK(drag.across_N_s_m == Approx(2.0 * drag.along_N_s_m));
  FluidConfig deep;
  deep.wall_gap_m = 0.1;  // far from the floor the rod keeps the drag of free fluid
  CHECK(rod_drag(NeedleConfig{}, deep).along_N_s_m == Approx(7.4e-5).epsilon(0.05));
}

TEST_CASE("break-away at the centre: the needle turns long before it is pulled") {
  const NeedleConfig needle;
  const NeedleMotion motion(needle, FluidConfig{}, smooth_friction(), DishConfig{});
  const FrictionMap map(smooth_friction(), 0.0425, 1);
  const auto break_away = [&](const CoilArray& array, const Pose2& pose) {
    double low = 0.0, high = 30.0;
    for (int i = 0; i < 40; ++i) {
      const double middle = (low + high) / 2.0;
      (motion.holds(pose, magnetic_wrench(needle, pose, array, {middle, 0.0, 0.0, 0.0}), map, 1.0) ? low
                                                                                                   : high) =
          middle;
    }
    return low;
  };
  CHECK(break_away(paper_coils(), {0, 0, 0}) == Approx(2.5).margin(0.8));
  CHECK(break_away(paper_coils(), {0, 0, geometry::kPi / 2}) == Approx(0.5).margin(0.2));
  const CoilArray published(make_field_table(published_coil_geometry(), 0.0425));
  CHECK(break_away(published, {0, 0, 0}) == Approx(2.5).margin(0.1));
  CHECK(break_away(published, {0, 0, geometry::kPi / 2}) == Approx(0.5).margin(0.1));
}

TEST_CASE("static limit surface of a rod") {
  const NeedleConfig needle;
  const FrictionConfig friction = smooth_friction();
  const NeedleMotion motion(needle, FluidConfig{}, friction, DishConfig{});
  const FrictionMap map(friction, 0.0425, 1);
  const double force = friction.static_coefficient * needle.net_weight_N;
  const double torque = force * needle.length_m / 4.0;
  const auto holds = [&](double along, double across, double turn) {
    return motion.holds({0.01, 0.0, 0.0}, {along * force, across * force, turn * torque}, map, 1.0);
  };
  CHECK(holds(0.99, 0, 0));
  CHECK_FALSE(holds(1.01, 0, 0));
  CHECK(holds(0, 0, 0.99));
  CHECK_FALSE(holds(0, 0, -1.01));
  // Turning about a point of the rod at a fraction f from its middle: force f, torque 1 - f^2.
  CHECK(holds(0, 0.6, 0.63));
  CHECK_FALSE(holds(0, 0.6, 0.65));
  CHECK_FALSE(holds(0.8, 0.0, 0.8));
  // A slippery needle lets go earlier.
  CHECK_FALSE(motion.holds({0, 0, 0}, {0.8 * force, 0, 0}, map, 0.7));
}

TEST_CASE("dry sliding and dry turning stop where Coulomb says") {
  const NeedleConfig needle;
  FrictionConfig friction = smooth_friction();
  friction.static_coefficient = friction.kinetic_coefficient;
  FluidConfig dry;
  dry.viscosity_Pa_s = 0.0;
  dry.cross_flow_factor = 0.0;
  const NeedleMotion motion(needle, dry, friction, DishConfig{});
  const FrictionMap map(friction, 0.0425, 1);
  const double force = friction.kinetic_coefficient * needle.net_weight_N;

  NeedleState slide = moving(0.12, 0.09, 0.0);
  for (int i = 0; i < 4000 && !slide.stuck; ++i) motion.step(slide, paper_coils(), {}, map, 1.0, 1e-4);
  CHECK(slide.stuck);
  const double distance = 0.5 * needle.mass_kg * 0.15 * 0.15 / force;
  CHECK(slide.pose.x_m == Approx(0.8 * distance).epsilon(0.01));
  CHECK(slide.pose.y_m == Approx(0.6 * distance).epsilon(0.01));
  CHECK(slide.pose.heading_rad == Approx(0.0).margin(1e-9));

  NeedleState spin = moving(0.0, 0.0, 20.0);
  for (int i = 0; i < 4000 && !spin.stuck; ++i) motion.step(spin, paper_coils(), {}, map, 1.0, 1e-4);
  CHECK(spin.stuck);
  const double angle = 0.5 * needle.inertia_kg_m2 * 400.0 / (force * needle.length_m / 4.0);
  CHECK(spin.pose.heading_rad == Approx(angle).epsilon(0.01));
}

TEST_CASE("viscous drag alone lets the needle coast exponentially") {
  const NeedleConfig needle;
  FrictionConfig none = smooth_friction();
  none.static_coefficient = none.kinetic_coefficient = 0.0;
  FluidConfig fluid;
  fluid.cross_flow_factor = 0.0;
  const NeedleMotion motion(needle, fluid, none, DishConfig{});
  const FrictionMap map(none, 0.0425, 1);
  const RodDrag drag = rod_drag(needle, fluid);
  NeedleState state = moving(0.05, 0.05, 0.0);
  for (int i = 0; i < 2000; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 1e-5);
  CHECK(state.velocity_x_m_s ==
        Approx(0.05 * std::exp(-drag.along_N_s_m * 0.02 / needle.mass_kg)).epsilon(1e-3));
  CHECK(state.velocity_y_m_s ==
        Approx(0.05 * std::exp(-drag.across_N_s_m * 0.02 / needle.mass_kg)).epsilon(1e-3));
}

TEST_CASE("without losses the energy is kept") {
  const NeedleConfig needle;
  FrictionConfig none = smooth_friction();
  none.static_coefficient = none.kinetic_coefficient = 0.0;
  FluidConfig dry;
  dry.viscosity_Pa_s = 0.0;
  dry.cross_flow_factor = 0.0;
  const NeedleMotion motion(needle, dry, none, DishConfig{});
  const FrictionMap map(none, 0.0425, 1);
  const PerCoil current{0.5, 0.0, 0.5, 0.0};
  NeedleState state = moving(0.0, 0.0, 0.0);
  state.pose = {-0.015, -0.01, 2.6};
  const double start = magnetic_energy(needle, state.pose, current);
  double worst = 0.0, largest = 0.0;
  for (int i = 0; i < 600; ++i) {
    motion.step(state, paper_coils(), current, map, 1.0, 0.5e-3);
    const double kinetic = kinetic_energy(needle, state);
    largest = std::max(largest, kinetic);
    worst = std::max(worst, std::abs(kinetic + magnetic_energy(needle, state.pose, current) - start));
  }
  CAPTURE(worst, largest);
  REQUIRE(largest > 1e-7);
  CHECK(worst < 2e-3 * largest);
}

TEST_CASE("friction, drag and wall never create energy") {
  const NeedleConfig needle;
  const FrictionConfig friction;
  const NeedleMotion motion(needle, FluidConfig{}, friction, DishConfig{});
  const FrictionMap map(friction, 0.0425, 7);
  for (const PerCoil& current :
       {PerCoil{8.0, 0.0, 0.0, 0.0}, PerCoil{12.0, 0.0, 9.0, 0.0}, PerCoil{0, 3, 0, 15}}) {
    NeedleState state;
    state.pose = {-0.01, 0.012, 2.2};
    double energy = magnetic_energy(needle, state.pose, current);
    const double start = energy;
    double gained = 0.0;
    for (int i = 0; i < 800; ++i) {
      motion.step(state, paper_coils(), current, map, 1.0, 0.25e-3);
      const double now = kinetic_energy(needle, state) + magnetic_energy(needle, state.pose, current);
      gained += std::max(0.0, now - energy);
      energy = now;
    }
    CAPTURE(current[0], start - energy, gained);
    REQUIRE(start - energy > 1e-6);
    CHECK(gained < 1e-3 * (start - energy));
  }
}

TEST_CASE("steps converge") {
  const FrictionConfig friction = smooth_friction();
  const NeedleMotion motion(NeedleConfig{}, FluidConfig{}, friction, DishConfig{});
  const FrictionMap map(friction, 0.0425, 1);
  const auto run = [&](double step_s) {
    NeedleState state;
    state.pose = {-0.012, 0.004, 1.2};
    const int steps = static_cast<int>(std::lround(0.1 / step_s));
    for (int i = 0; i < steps; ++i) motion.step(state, paper_coils(), {9.0, 0.0, 0.0, 2.0}, map, 1.0, step_s);
    for (int i = 0; i < 2 * steps && !state.stuck; ++i)
      motion.step(state, paper_coils(), {}, map, 1.0, step_s);
    REQUIRE(state.stuck);
    return state.pose;
  };
  const Pose2 fine = run(1.5625e-5);
  const auto error_m = [&](double step_s) {
    const Pose2 pose = run(step_s);
    return (pose.position_m() - fine.position_m()).norm() +
           NeedleConfig{}.length_m / 2.0 *
               std::abs(geometry::wrap_angle(pose.heading_rad - fine.heading_rad));
  };
  const double travel = (fine.position_m() - Vector2(-0.012, 0.004)).norm();
  REQUIRE(travel > 5e-3);
  const double coarse = error_m(1e-3), normal = error_m(0.5e-3), half = error_m(0.125e-3);
  CAPTURE(travel, coarse, normal, half);
  CHECK(normal < 0.02 * travel);
  CHECK(half < 0.4 * normal);
  CHECK(half < 0.25 * coarse);
}

TEST_CASE("the wall stops both ends, inelastically") {
  const NeedleConfig needle;
  const DishConfig dish;
  const NeedleMotion motion(needle, FluidConfig{}, FrictionConfig{}, dish);
  const FrictionMap map(FrictionConfig{}, dish.radius_m, 1);
  for (const double heading : {0.0, 0.7, 1.5, 3.0}) {
    for (const double spin : {0.0, 40.0, -40.0}) {
      NeedleState state = moving(0.5, 0.2, spin);
      state.pose.heading_rad = heading;
      for (int i = 0; i < 1000; ++i) {
        motion.step(state, paper_coils(), {15.0, 0.0, 8.0, 0.0}, map, 1.0, 0.5e-3);
        REQUIRE(motion.fits(state.pose));
      }
      CHECK(std::hypot(state.velocity_x_m_s, state.velocity_y_m_s) < 5e-3);
      for (int i = 0; i < 400 && !state.stuck; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3);
      CHECK(state.stuck);
    }
  }
  // Straight into the wall: the end stays at the wall, no bounce.
  NeedleState state = moving(0.8, 0.0, 0.0);
  state.pose.x_m = 0.0295;
  for (int i = 0; i < 20; ++i) motion.step(state, paper_coils(), {}, map, 1.0, 0.5e-3);
  CHECK(state.pose.x_m == Approx(dish.radius_m - needle.length_m / 2.0).margin(1e-6));
  CHECK(std::abs(state.velocity_x_m_s) < 1e-6);
  CHECK_FALSE(motion.fits({0.0, 0.0, std::nan("")}));
}

TEST_CASE("a chain longer than its needle is refused") {
  NeedleConfig needle;
  needle.chain_m = 0.03;
  CHECK_THROWS_AS(NeedleMotion(needle, FluidConfig{}, FrictionConfig{}, DishConfig{}), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::physics
