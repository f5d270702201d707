#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <memory>

#include "lodestone/common/error.h"
#include "lodestone/physics/coil_circuit.h"
#include "lodestone/rig/virtual_rig.h"
#include "rig/coils_conformance.h"
#include "rig/described_rig.h"

namespace lodestone::rig {
namespace {

/// Of all rigs here; held, so that they are tabulated once.
std::shared_ptr<const physics::CoilFields> kept_fields() {
  static const auto fields =
      physics::CoilFields::shared(physics::CoilsDescription{}, physics::DishConfig{}.radius_m);
  return fields;
}

/// Everything at once that drivers of duties do.
VirtualRigConfig ramping_rig() {
  VirtualRigConfig config = tests::described_rig();
  config.amplifier.ramp_s = 0.05;
  config.amplifier.duty_steps = 32767;
  config.amplifier.resistance_after_s = 0.03;
  config.amplifier.current_step_A = 1e-3;
  config.amplifier.axis_skew_s = 0.7e-3;
  config.supply_resistance_ohm = 0.1;
  return config;
}

VirtualRigConfig current_driven_rig() {
  VirtualRigConfig config = tests::described_rig();
  config.amplifier.controls = physics::AmplifierControl::kCurrent;
  config.amplifier.time_constant_s = 1e-3;
  config.supply_resistance_ohm = 0.1;
  return config;
}

/// What the coils are at after a pulse, another in the middle of it, and a stop. Every wait is cut into
/// pieces of this length.
CoilStatus status_after(const VirtualRigConfig& config, double end_s, double piece_s) {
  VirtualRig rig(config, 1, kept_fields());
  const auto wait_until = [&](double time_s) {
    const double until_s = std::min(time_s, end_s);
    while (rig.clock().now_s() + piece_s < until_s) rig.clock().sleep_until(rig.clock().now_s() + piece_s);
    rig.clock().sleep_until(until_s);
  };
  wait_until(0.0013);
  rig.coils().apply({{6.0, 0.0, 0.0, 4.0}, 0.08});
  wait_until(0.1);
  if (end_s > 0.1) rig.coils().apply({{0.0, 5.0, 0.0, -3.0}, 0.1});
  wait_until(0.107);
  if (end_s > 0.107) rig.coils().apply({{2.0, 0.0, 7.0, 0.0}, 0.1});
  wait_until(0.15);
  if (end_s > 0.15) rig.coils().stop();
  wait_until(0.3);
  return rig.coils().status();
}

TEST_CASE("currents do not depend on how waits are cut, on a ramp either") {
  for (const VirtualRigConfig& config : {ramping_rig(), current_driven_rig()}) {
    for (const double end_s : {0.004, 0.0437, 0.0813, 0.09, 0.1062, 0.149, 0.1571, 0.3}) {
      const CoilStatus whole = status_after(config, end_s, 1.0);
      for (const double piece_s : {0.37e-3, 0.0021}) {
        const CoilStatus cut = status_after(config, end_s, piece_s);
        for (std::size_t coil = 0; coil < 4; ++coil) {
          CAPTURE(end_s, piece_s, coil);
          CHECK(std::abs(cut.current_A[coil] - whole.current_A[coil]) < 1e-9);
          CHECK(std::abs(cut.temperature_C[coil] - whole.temperature_C[coil]) < 1e-9);
        }
      }
    }
  }
}

TEST_CASE("a rig whose drivers follow at once has its circuits' own currents, and nothing more to save") {
  const VirtualRigConfig config = tests::described_rig();
  VirtualRig rig(config, 1, kept_fields());
  physics::CoilCircuit alone(config.circuit(0));
  rig.coils().apply({{6.0, 0.0, 0.0, 0.0}, 0.1});
  alone.demand(6.0);
  rig.clock().sleep_until(0.1);
  alone.advance(0.1);
  CHECK(rig.coils().status().current_A[0] == alone.state().current_A);
  CHECK(rig.coils().status().temperature_C[0] == alone.state().temperature_C);
  rig.clock().sleep_until(0.11);
  alone.off();
  alone.advance(rig.clock().now_s() - 0.1);
  CHECK(rig.coils().status().current_A[0] == alone.state().current_A);
  CHECK_FALSE(rig.save().contains("coils_s"));
  CHECK_FALSE(rig.save().contains("amplifier"));
}

TEST_CASE("save and restore go on bitwise in the middle of a ramp") {
  for (const VirtualRigConfig& config : {ramping_rig(), current_driven_rig()}) {
    for (const double into_s : {0.0003, 0.0047, 0.07, 0.1031}) {
      VirtualRig rig(config, 4, kept_fields());
      rig.place({0.01, -0.01, 1.0});
      rig.coils().apply({{6.0, 0.0, 0.0, 4.0}, 0.1});
      rig.clock().sleep_until(into_s);
      const common::Json saved = common::Json::parse(rig.save().dump());
      VirtualRig other(config, 4, kept_fields());
      other.restore(saved);
      CHECK(other.save() == rig.save());
      for (VirtualRig* each : {&rig, &other}) {
        each->clock().sleep_until(0.25);
        each->coils().apply({{0.0, 3.0, 5.0, 0.0}, 0.1});
        each->clock().sleep_until(0.5);
      }
      CAPTURE(into_s);
      CHECK(other.save() == rig.save());

      common::Json broken = saved;
      broken["amplifier"].erase("outputs");
      const common::Json before = other.save();
      CHECK_THROWS_AS(other.restore(broken), common::DataError);
      broken = saved;
      broken["coils_s"] = 1.0;
      CHECK_THROWS_WITH(other.restore(broken), Catch::Contains("coils_s = 1"));
      CHECK(other.save() == before);
    }
  }
}

TEST_CASE("a state that says nothing of drivers goes on with what drives the coils") {
  VirtualRig at_once(tests::described_rig(), 1, kept_fields());
  at_once.coils().apply({{6.0, 0.0, 0.0, 0.0}, 0.1});
  at_once.clock().sleep_until(0.06);
  for (const VirtualRigConfig& config : {ramping_rig(), current_driven_rig()}) {
    VirtualRig rig(config, 1, kept_fields());
    rig.restore(at_once.save());
    CHECK(rig.coils().status().current_A == at_once.coils().status().current_A);
    rig.clock().sleep_until(0.095);
    CHECK(rig.coils().status().current_A[0] == Approx(6.0).epsilon(0.04));
    rig.clock().sleep_until(0.3);
    CHECK(std::abs(rig.coils().status().current_A[0]) < 1e-3);
  }
  VirtualRig ramping(ramping_rig(), 1, kept_fields());
  ramping.coils().apply({{6.0, 0.0, 0.0, 0.0}, 0.1});
  ramping.clock().sleep_until(0.0523);
  at_once.restore(ramping.save());
  CHECK(at_once.coils().status().current_A == ramping.coils().status().current_A);
  at_once.clock().sleep_until(0.3);
  CHECK(std::abs(at_once.coils().status().current_A[0]) < 1e-3);
}

TEST_CASE("a stop is what motor controllers make of it: they ramp down") {
  const auto after_stop_A = [](const VirtualRigConfig& config, double later_s) {
    VirtualRig rig(config, 1, kept_fields());
    rig.coils().apply({{10.0, 0.0, 0.0, 0.0}, 1.0});
    rig.clock().sleep_until(0.3);
    rig.coils().stop();
    rig.clock().sleep_until(0.3 + later_s);
    return rig.coils().status().current_A[0];
  };
  CHECK(after_stop_A(tests::described_rig(), 0.01) < 4.0);
  CHECK(after_stop_A(ramping_rig(), 0.01) > 7.0);
  CHECK(std::abs(after_stop_A(ramping_rig(), 0.1)) < 0.1);
  CHECK(std::abs(after_stop_A(current_driven_rig(), 0.01)) < 0.1);
}

/// Lets the rig run on at once.
class UnhurriedClock final : public common::Clock {
 public:
  double now_s() const override { return 50.0; }
  bool wait_until(double, common::Interruption*) override {
    ++waits;
    return true;
  }
  int waits = 0;
};

TEST_CASE("a rig with ramps that keeps pace with a clock does bitwise the same, and waits no more often") {
  VirtualRig free(ramping_rig(), 3, kept_fields());
  VirtualRig paced(ramping_rig(), 3, kept_fields());
  VirtualRig at_once(tests::described_rig(), 3, kept_fields());
  UnhurriedClock wall;
  UnhurriedClock other_wall;
  paced.keep_pace_with(wall);
  at_once.keep_pace_with(other_wall);
  for (int step = 0; step < 5; ++step) {
    for (VirtualRig* rig : {&free, &paced, &at_once}) {
      rig->coils().apply({{6.0, 0.0, 2.0, 0.0}, 0.1});
      rig->clock().sleep_until(0.3 * (step + 1));
    }
    CHECK(free.save() == paced.save());
  }
  CHECK(free.true_pose().position_m().norm() > 0.001);
  CHECK(wall.waits > 100);
  CHECK(wall.waits < 2 * other_wall.waits);
}

TEST_CASE("the virtual rig's coils keep the contract of Coils behind any drivers") {
  for (const VirtualRigConfig& config : {ramping_rig(), current_driven_rig()}) {
    VirtualRig rig(config, 1, kept_fields());
    tests::check_coils_conformance(rig.coils(), rig.clock(), config.coils.max_current_A, 0.1);
  }
}

}  // namespace
}  // namespace lodestone::rig
