#include "lodestone/rig/virtual_rig.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/physics/core_saturation.h"
#include "lodestone/physics/plain_simulator.h"
#include "other_rigs.h"
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

struct Outcome {
  double moved_mm;
  double at_pulse_end_mm;
  bool at_rest;
};

Outcome pull(double x_m, double current_A) {
  VirtualRig rig(smooth(), 1, shared_fields());
  rig.place({x_m, 0.0, 0.0});
  rig.coils().apply({{current_A, 0.0, 0.0, 0.0}, 0.1});
  rig.clock().sleep_until(0.1);
  const double during = rig.true_pose().x_m;
  rig.clock().sleep_until(0.3);
  CHECK(std::abs(rig.true_pose().y_m) < 1e-9);
  return {1e3 * (rig.true_pose().x_m - x_m), 1e3 * (during - x_m), rig.at_rest()};
}

TEST_CASE("displacements are near those of the design notes' trial integration") {
  // Notes: 0 mm 4 A about 5, 6 A about 17; -20 mm 8 A 6, 15 A 26; +10 mm 3 A 8.
  const double expected[][3] = {
      {0.0, 4.0, 5.0}, {0.0, 6.0, 17.0}, {-0.02, 8.0, 6.0}, {-0.02, 15.0, 26.0}, {0.01, 3.0, 8.0}};
  for (const auto& row : expected) {
    const Outcome outcome = pull(row[0], row[1]);
    CAPTURE(row[0], row[1], outcome.moved_mm);
    CHECK(outcome.moved_mm == Approx(row[2]).epsilon(0.35));
    CHECK(outcome.at_rest);
    CHECK(outcome.at_pulse_end_mm > 0.0);
    CHECK(outcome.at_pulse_end_mm < outcome.moved_mm);
  }
}

TEST_CASE("below break-away nothing moves at all") {
  CHECK(pull(0.0, 2.0).moved_mm == 0.0);
  CHECK(pull(-0.02, 4.0).moved_mm == 0.0);
  CHECK(pull(0.0, 0.0).moved_mm == 0.0);
}

TEST_CASE("below the pull of translation a needle still turns into the field") {
  VirtualRig rig(smooth(), 1, shared_fields());
  rig.place({0.0, 0.0, 2.0});
  for (int i = 0; i < 4; ++i) {
    rig.coils().apply({{1.5, 0.0, 0.0, 0.0}, 0.1});
    rig.clock().sleep_until(rig.clock().now_s() + 0.3);
  }
  CHECK(std::abs(rig.true_pose().heading_rad) < 0.5);
  // It walks a little: while it turns, friction spends itself on the turning and resists the pull less.
  CHECK(rig.true_pose().position_m().norm() < 0.2 * rig.config().needle.length_m);
}

TEST_CASE("the four coils are equal: a quarter turn of everything turns the result") {
  const double quarter = std::acos(-1.0) / 2.0;
  VirtualRig a(smooth(), 1, shared_fields()), b(smooth(), 1, shared_fields());
  a.place({0.006, -0.004, 0.3});
  b.place({0.004, 0.006, 0.3 + quarter});
  a.coils().apply({{6.0, 0.0, 0.0, 3.0}, 0.1});  // +x, -y
  b.coils().apply({{3.0, 0.0, 6.0, 0.0}, 0.1});  // +y, +x
  a.clock().sleep_until(0.3);
  b.clock().sleep_until(0.3);
  CHECK(a.true_pose().position_m().norm() > 0.01);
  CHECK(b.true_pose().x_m == Approx(-a.true_pose().y_m).margin(1e-9));
  CHECK(b.true_pose().y_m == Approx(a.true_pose().x_m).margin(1e-9));
}

TEST_CASE("coils warm up and then give less current") {
  VirtualRigConfig config = smooth();
  config.coils.cooling_W_per_K = 1.0;
  config.simulation.step_s = 5e-3;  // the needle's path is of no concern here
  VirtualRig rig(config, 1, shared_fields());
  const auto current_at_end = [&] {
    rig.coils().apply({{15.0, 0.0, 0.0, 0.0}, 10.0});
    rig.clock().sleep_until(rig.clock().now_s() + 9.9);
    return rig.coils().status().current_A[0];
  };
  const double cool = current_at_end();
  for (int i = 0; i < 30; ++i) current_at_end();
  const CoilStatus hot = rig.coils().status();
  CHECK(hot.temperature_C[0] > config.simulation.max_temperature_C);
  REQUIRE(hot.faults.size() == 1);
  CHECK_THAT(hot.faults[0], Catch::Contains("coil +x"));
  CHECK(hot.temperature_C[1] == Approx(config.ambient_C));
  CHECK(current_at_end() < 0.8 * cool);
}

TEST_CASE("friction differs over the dish, between rigs and between pulses; one seed repeats itself") {
  const auto move = [](std::uint64_t seed, double x_m, double y_m, int pulses) {
    VirtualRig rig(tests::described_rig(), seed, shared_fields());
    double moved = 0.0;
    for (int i = 0; i < pulses; ++i) {
      rig.place({x_m, y_m, 0.0});
      rig.coils().apply({{8.0, 0.0, 0.0, 0.0}, 0.1});
      rig.clock().sleep_until(rig.clock().now_s() + 0.6);
      moved = rig.true_pose().x_m - x_m;
    }
    return moved;
  };
  CHECK(move(1, -0.01, 0.01, 1) == move(1, -0.01, 0.01, 1));
  CHECK(move(1, -0.01, 0.01, 1) != move(2, -0.01, 0.01, 1));
  CHECK(std::abs(move(1, -0.01, 0.01, 1) - move(1, -0.01, -0.01, 1)) > 1e-5);
  CHECK(std::abs(move(1, -0.01, 0.01, 1) - move(1, -0.01, 0.01, 2)) > 1e-5);
}

TEST_CASE("needles come to rest within the rest, inside the dish, wherever they start") {
  VirtualRig rig(tests::described_rig(), 5, shared_fields());
  common::RandomStream random(5, "test");
  int resting = 0;
  for (int i = 0; i < 100; ++i) {
    Pose2 pose;
    do {
      pose = {random.uniform(-0.04, 0.04), random.uniform(-0.04, 0.04), random.uniform(-3.1, 3.1)};
    } while (!rig.fits(pose));
    rig.place(pose);
    rig.coils().apply(random_pulse(random));
    rig.clock().sleep_until(rig.clock().now_s() + 0.3);
    resting += rig.at_rest() ? 1 : 0;
    REQUIRE(rig.fits(rig.true_pose()));
  }
  CHECK(resting >= 99);
}

TEST_CASE("save and restore go on bitwise, also in the middle of a pulse") {
  const VirtualRigConfig config = tests::described_rig();
  common::RandomStream random(9, "test");
  VirtualRig rig(config, 4, shared_fields());
  rig.place({0.01, -0.01, 1.0});
  for (int i = 0; i < 3; ++i) {
    rig.coils().apply(random_pulse(random));
    rig.clock().sleep_until(rig.clock().now_s() + 0.3);
  }
  rig.coils().apply(random_pulse(random));
  rig.clock().sleep_until(rig.clock().now_s() + 0.05);
  const common::Json saved = common::Json::parse(rig.save().dump());
  VirtualRig other(config, 4, shared_fields());
  other.restore(saved);
  CHECK(other.save() == rig.save());
  const CoilPulse next = random_pulse(random);
  for (VirtualRig* each : {&rig, &other}) {
    each->clock().sleep_until(each->clock().now_s() + 0.25);
    each->coils().apply(next);
    each->clock().sleep_until(each->clock().now_s() + 0.3);
  }
  CHECK(same_bits(rig.true_pose(), other.true_pose()));
  CHECK(other.save() == rig.save());

  VirtualRig stranger(config, 5, shared_fields());
  CHECK_THROWS_AS(stranger.restore(saved), common::DataError);
  common::Json broken = saved;
  broken.erase("coils");
  const common::Json before = other.save();
  CHECK_THROWS_AS(other.restore(broken), common::DataError);
  CHECK(other.save() == before);
}

TEST_CASE("a sphere is drawn to a coil, has no heading, and goes on bitwise after a restart") {
  VirtualRigConfig config = tests::described_rig();
  config.needle = tests::sphere();
  VirtualRig rig(config, 4, shared_fields());
  rig.place({-0.01, 0.004, 1.0});
  CHECK(rig.true_pose().heading_rad == 0.0);
  CHECK(rig.fits({0.0, 0.04, 0.0}));
  CHECK_FALSE(rig.fits({0.0, 0.0415, 0.0}));
  rig.coils().apply({{9.0, 0.0, 0.0, 0.0}, 0.1});
  rig.clock().sleep_until(0.11);
  const common::Json saved = common::Json::parse(rig.save().dump());
  VirtualRig other(config, 4, shared_fields());
  other.restore(saved);
  for (VirtualRig* each : {&rig, &other}) each->clock().sleep_until(2.0);
  CHECK(rig.true_pose().x_m > -0.009);
  CHECK(rig.true_pose().heading_rad == 0.0);
  CHECK(rig.at_rest());
  CHECK(same_bits(rig.true_pose(), other.true_pose()));
  CHECK(other.save() == rig.save());
}

TEST_CASE("rigs do the same on any number of threads") {
  const auto run = [](std::size_t threads) {
    common::ThreadPool pool(threads);
    std::vector<std::unique_ptr<VirtualRig>> rigs;
    for (std::uint64_t i = 0; i < 6; ++i) {
      rigs.push_back(std::make_unique<VirtualRig>(tests::described_rig(), 100 + i, shared_fields()));
    }
    common::RandomStream random(3, "pulses");
    for (int step = 0; step < 10; ++step) {
      std::vector<CoilPulse> pulses;
      for (std::size_t i = 0; i < rigs.size(); ++i) pulses.push_back(random_pulse(random));
      pool.for_each(rigs.size(), [&](std::size_t i) {
        rigs[i]->coils().apply(pulses[i]);
        rigs[i]->clock().sleep_until(0.3 * (step + 1));
      });
    }
    std::vector<Pose2> poses;
    for (const auto& rig : rigs) poses.push_back(rig->true_pose());
    return poses;
  };
  const auto one = run(1), two = run(2), four = run(4);
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(same_bits(one[i], two[i]));
    CHECK(same_bits(one[i], four[i]));
  }
  CHECK_FALSE(same_bits(one[0], one[1]));
}

TEST_CASE("what cannot be is refused") {
  VirtualRig rig(tests::described_rig(), 1, shared_fields());
  CHECK_THROWS_AS(rig.place({0.04, 0.0, 0.0}), common::DataError);
  CHECK_THROWS_AS(rig.place({std::nan(""), 0.0, 0.0}), common::DataError);
  CHECK_THROWS_AS(rig.clock().sleep_until(std::nan("")), common::LogicFault);
  VirtualRigConfig other = tests::described_rig();
  other.coils.geometry.turns = 500;
  CHECK_THROWS_AS(VirtualRig(other, 1, shared_fields()), common::LogicFault);
  const auto read = [](const char* json) {
    return common::config_from_json<VirtualRigConfig>(common::Json::parse(json), "test");
  };
  CHECK(read(R"({"needle": {"mass_kg": 1e-4}})").needle.mass_kg == 1e-4);
  CHECK_THROWS_AS(read(R"({"needle": {"chain_m": 0.05}})"), common::ConfigError);
  CHECK_NOTHROW(read(R"({"dish": {"radius_m": 0.04}})"));
  CHECK_THROWS_AS(read(R"({"dish": {"radius_m": 0.01}})"), common::ConfigError);
  CHECK_THROWS_AS(read(R"({"friction": {"kinetic_coefficient": 0.9}})"), common::ConfigError);
  CHECK_THROWS_AS(read(R"({"coils": {"inner_radius_m": 0.2}})"), common::ConfigError);
}

TEST_CASE("a rig of other coils drives its needle, and each coil within its own limits") {
  VirtualRigConfig config = smooth();
  const physics::RigDescription six = tests::ring_rig(6);
  config.coils = six.coils;
  config.drive = six.drive;
  VirtualRig rig(config, 1);
  REQUIRE(rig.coils().status().current_A.size() == 6);
  const physics::CoilDrive drive(config);
  for (const double angle_rad : {0.0, 0.6, 2.2, 4.0}) {
    const geometry::Vector2 along(std::cos(angle_rad), std::sin(angle_rad));
    rig.place({0.0, 0.0, angle_rad});
    rig.coils().apply({drive.current_A(config.coils.max_current_A * along, {0.0, 0.0}), 0.1});
    rig.clock().sleep_until(rig.clock().now_s() + 0.3);
    const geometry::Vector2 moved_m = rig.true_pose().position_m();
    CHECK(moved_m.dot(along) > 0.9 * moved_m.norm());
    CHECK(moved_m.norm() > 1e-3);
  }
  CoilPulse pulse;
  pulse.duration_s = 0.1;
  pulse.current_A[4] = -1.0;  // unipolar
  CHECK_THROWS_WITH(rig.coils().apply(pulse),
                    Catch::Contains("coil c5 = -1 A is refused; it must be within 0 and 15"));
  pulse.current_A[4] = 0.0;
  pulse.current_A[6] = 1.0;
  CHECK_THROWS_WITH(rig.coils().apply(pulse), Catch::Contains("must be within 0 and 0 A"));
  // Saved and restored, with all its coils.
  const common::Json saved = rig.save();
  CHECK(saved["coils"].size() == 6);
  VirtualRig other(config, 1);
  other.restore(saved);
  CHECK(other.save() == saved);
  CHECK_THROWS_WITH(VirtualRig(smooth(), 1).restore(saved), Catch::Contains("6 coils, this rig has 4"));
}

TEST_CASE("cores that saturate pull less than in proportion, and only where they are asked for") {
  const auto moved_mm = [](double current_A, double core_share) {
    VirtualRigConfig config = smooth();
    config.simulation.core_share = core_share;
    config.simulation.core_saturation_A = 6.0;
    VirtualRig rig(config, 1, shared_fields());
    rig.coils().apply({{current_A, 0.0, 0.0, 0.0}, 0.1});
    rig.clock().sleep_until(0.3);
    return 1e3 * rig.true_pose().x_m;
  };
  CHECK(moved_mm(6.0, 0.0) == pull(0.0, 6.0).moved_mm);
  const double plain_mm = moved_mm(6.0, 0.0), saturated_mm = moved_mm(6.0, 0.9);
  CHECK((saturated_mm > 0.3 && saturated_mm < 0.7 * plain_mm));
  // As a coil without one does at the current that its field is then that of.
  const double equal_A = physics::unsaturated_A(6.0, 0.9, 6.0);
  CHECK(saturated_mm ==
        Approx(moved_mm(equal_A, 0.0)).epsilon(0.15));  // while the current rises, it has more
}

TEST_CASE("a simulator that is linear in the currents fails where cores saturate") {
  const auto missed = [](double core_share) {
    VirtualRigConfig config = smooth();
    config.simulation.core_share = core_share;
    config.simulation.core_saturation_A = 3.0;
    VirtualRig rig(config, 1, shared_fields());
    const physics::PlainSimulator described(config, {});
    common::RandomStream random(4, "pulses");
    double missed_m2 = 0.0, moved_m2 = 0.0;
    for (int i = 0; i < 40; ++i) {
      const Pose2 from{random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(-3.0, 3.0)};
      const physics::PerCoil current_A =
          physics::opposed_pairs_A({random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0)});
      rig.place(from);
      rig.coils().apply({current_A, 0.1});
      rig.clock().sleep_until(rig.clock().now_s() + 0.3);
      const geometry::Vector2 to_m = rig.true_pose().position_m();
      missed_m2 += (described.step(from, current_A, 0.1, 0.2).position_m() - to_m).squaredNorm();
      moved_m2 += (from.position_m() - to_m).squaredNorm();
    }
    return std::sqrt(missed_m2 / moved_m2);
  };
  CHECK(missed(0.9) > 2.0 * missed(0.0));
}

TEST_CASE("a field that presses the needle down adds friction, one that lifts it takes some") {
  VirtualRigConfig config = smooth();
  const physics::RigDescription below = tests::ring_rig(8, 0.04);
  config.coils = below.coils;
  config.drive = below.drive;
  const physics::CoilArray coils(
      std::make_shared<const physics::CoilFields>(config.coils, config.dish.radius_m));
  const physics::NeedleMotion motion(config.needle, config.fluid, config.friction, config.dish);
  const physics::FrictionMap even(config.friction, config.dish.radius_m, 1);
  const physics::PerCoil current_A = {15.0};
  const Pose2 pose{0.0, 0.0, 0.0};
  physics::Wrench wrench = physics::magnetic_wrench(config.needle, pose, coils, current_A);
  REQUIRE(std::abs(wrench.lift_N) > 0.02 * config.needle.net_weight_N);
  // The pull that the floor just holds grows and shrinks with what presses on it.
  const auto held_N = [&](double lift_N) {
    double least_N = 0.0, most_N = 2e-3;
    for (int i = 0; i < 40; ++i) {
      const double middle_N = 0.5 * (least_N + most_N);
      (motion.holds(pose, {middle_N, 0.0, 0.0, lift_N}, even, 1.0) ? least_N : most_N) = middle_N;
    }
    return least_N;
  };
  const double weight_N = config.needle.net_weight_N;
  CHECK(held_N(-0.3 * weight_N) == Approx(1.3 * held_N(0.0)));
  CHECK(held_N(0.4 * weight_N) == Approx(0.6 * held_N(0.0)));
  CHECK(held_N(1.5 * weight_N) == Approx(0.0).margin(1e-9));
}

TEST_CASE("a rig that keeps pace with a clock does bitwise the same, and shows what lies between") {
  VirtualRig free(tests::described_rig(), 3, shared_fields());
  VirtualRig paced(tests::described_rig(), 3, shared_fields());
  StepClock wall;
  paced.keep_pace_with(wall);
  std::set<double> seen_m;
  wall.look = [&] { seen_m.insert(paced.true_pose().x_m); };
  for (int step = 0; step < 5; ++step) {
    for (VirtualRig* rig : {&free, &paced}) {
      rig->coils().apply({{6.0, 0.0, 2.0, 0.0}, 0.1});
      rig->clock().sleep_until(0.3 * (step + 1));
    }
    CHECK(free.save() == paced.save());
  }
  CHECK(free.true_pose().x_m > 0.001);
  CHECK(seen_m.size() > 20);
  CHECK(std::is_sorted(wall.waits.begin(), wall.waits.end()));
  CHECK(wall.waits.back() == Approx(1.5));
}

TEST_CASE("a stop in the middle of a rest switches off then, and an interruption ends the rest") {
  VirtualRig rig(tests::described_rig(), 3, shared_fields());
  StepClock wall;
  rig.keep_pace_with(wall);
  wall.look = [&] {
    if (wall.waits.size() == 8) rig.coils().stop();
  };
  rig.coils().apply({{6.0, 0.0, 0.0, 0.0}, 0.2});
  rig.clock().sleep_until(0.04);
  CHECK(rig.coils().status().current_A[0] > 5.0);
  rig.clock().sleep_until(0.1);
  CHECK(std::abs(rig.coils().status().current_A[0]) < 0.1);

  common::Interruption interruption;
  wall.look = [&] {
    if (rig.clock().now_s() > 0.15) interruption.raise();
  };
  CHECK_FALSE(rig.clock().wait_until(0.5, &interruption));
  CHECK(rig.clock().now_s() < 0.2);
  CHECK_FALSE(rig.clock().wait_until(0.5, &interruption));
}

// One thread drives, one watches, one stops.
TEST_CASE("the virtual rig may be watched and stopped from any thread") {
  VirtualRig rig(tests::described_rig(), 3, shared_fields());
  common::SteadyClock wall;
  rig.keep_pace_with(wall);
  std::atomic<bool> over{false};
  std::thread watcher([&] {
    while (!over) {
      rig.true_pose();
      rig.coils().status();
      rig.clock().now_s();
      rig.save();
    }
  });
  std::thread stopper([&] {
    while (!over) rig.coils().stop();
  });
  for (int step = 0; step < 20; ++step) {
    rig.coils().apply({{6.0, 0.0, 0.0, 0.0}, 0.01});
    rig.clock().sleep_until(0.02 * (step + 1));
  }
  over = true;
  watcher.join();
  stopper.join();
  CHECK(rig.clock().now_s() == Approx(0.4));
  rig.coils().stop();
  rig.clock().sleep_until(0.6);
  CHECK(std::abs(rig.coils().status().current_A[0]) < 0.1);
}

}  // namespace
}  // namespace lodestone::rig
