#include "lodestone/physics/amplifier.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <functional>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

/// Coils and their drivers in time.
struct DrivenCircuits {
  explicit DrivenCircuits(const RigDescription& rig) : amplifier(rig) {
    for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) circuits.emplace_back(rig.circuit(coil));
  }
  void demand(const PerCoil& current_A) { amplifier.demand(current_A, now_s, Amplifier::kNever_s, circuits); }
  void off() { amplifier.off(now_s, circuits); }
  void run_to(double time_s) {
    while (now_s < time_s) {
      const double end_s = std::min(time_s, amplifier.change_s());
      for (CoilCircuit& circuit : circuits) circuit.advance(end_s - now_s);
      now_s = end_s;
      if (now_s >= amplifier.change_s()) amplifier.change(now_s, circuits);
    }
  }
  double current_A(std::size_t coil) const { return circuits[coil].state().current_A; }

  Amplifier amplifier;
  Amplifier::Circuits circuits;
  double now_s = 0.0;
};

/// Coils that do not change with temperature.
RigDescription even_coils() {
  RigDescription rig;
  rig.coils.temperature_coefficient_per_K = 0.0;
  return rig;
}

/// Current of a coil under this voltage from time 0 on, by the trapezoidal rule in steps of a microsecond.
double integrated_A(const CircuitConfig& coil, const std::function<double(double)>& volt, double end_s) {
  const double step_s = 1e-6;
  const auto steps = static_cast<int>(std::lround(end_s / step_s));
  const double inertia = coil.inductance_H / step_s;
  double current_A = 0.0;
  for (int step = 0; step < steps; ++step) {
    const double mean_V = 0.5 * (volt(step * step_s) + volt((step + 1) * step_s));
    current_A = ((inertia - 0.5 * coil.resistance_20C_ohm) * current_A + mean_V) /
                (inertia + 0.5 * coil.resistance_20C_ohm);
  }
  return current_A;
}

TEST_CASE("drivers that follow at once are the circuits' own") {
  const RigDescription rig;
  DrivenCircuits driven(rig);
  CoilCircuit alone(rig.circuit(0));
  CHECK_FALSE(driven.amplifier.shapes());
  CHECK_FALSE(driven.amplifier.stepwise());
  driven.demand({7.0});
  alone.demand(7.0);
  CHECK(driven.amplifier.change_s() == Amplifier::kNever_s);
  driven.run_to(0.1);
  alone.advance(0.1);
  CHECK(driven.current_A(0) == alone.state().current_A);
  CHECK(driven.circuits[0].state().temperature_C == alone.state().temperature_C);
  driven.off();
  CHECK(driven.circuits[0].state().duty == 0.0);
}

TEST_CASE("a ramp gives the current that a fine integration gives, and loses no charge") {
  RigDescription rig = even_coils();
  rig.amplifier.ramp_s = 0.05;
  const double target = 10.0 * 1.9 / 34.0;
  const auto volt = [&](double time_s) {
    const double up = std::min(target, time_s / 0.05);
    const double down = std::max(0.0, target - (time_s - 0.1) / 0.05);
    return 34.0 * (time_s < 0.1 ? up : down);
  };
  DrivenCircuits driven(rig);
  driven.demand({10.0});
  for (const double time_s : {0.0033, 0.01, 0.0279, 0.05, 0.1}) {
    driven.run_to(time_s);
    CAPTURE(time_s);
    CHECK(driven.current_A(0) == Approx(integrated_A(rig.circuit(0), volt, time_s)).margin(5e-3));
  }
  CHECK(driven.current_A(0) == Approx(10.0).epsilon(1e-3));
  driven.off();
  for (const double time_s : {0.1021, 0.11, 0.1279, 0.15}) {
    driven.run_to(time_s);
    CAPTURE(time_s);
    CHECK(driven.current_A(0) == Approx(integrated_A(rig.circuit(0), volt, time_s)).margin(5e-3));
  }
  CHECK(driven.amplifier.change_s() == Amplifier::kNever_s);

  DrivenCircuits whole(rig);
  double charge_As = 0.0;
  double before_A = 0.0;
  whole.demand({10.0});
  for (int step = 1; step <= 4000; ++step) {
    whole.run_to(1e-4 * step);
    charge_As += 0.5e-4 * (before_A + whole.current_A(0));
    before_A = whole.current_A(0);
    if (step == 1000) whole.off();
  }
  CHECK(charge_As == Approx(10.0 * 0.1).epsilon(1e-3));
}

TEST_CASE("a weak supply sags under the coils together") {
  CHECK(sagged_V(34.0, 0.2, {10.0, -10.0}) == Approx(30.0));
  CHECK(sagged_V(1.0, 0.2, {10.0}) == 0.0);
  RigDescription rig = even_coils();
  rig.supply_resistance_ohm = 0.2;
  const double duty = 10.0 * 1.9 / 34.0;
  // Both coils alike: each sees a resistance more, of both currents through the supply.
  const double seen_ohm = 1.9 + 2.0 * 0.2 * duty;
  DrivenCircuits two(rig);
  two.demand({10.0, 0.0, -10.0, 0.0});
  for (const double time_s : {0.002, 0.005, 0.01, 0.03}) {
    two.run_to(time_s);
    const double risen = 1.0 - std::exp(-time_s * seen_ohm / rig.coils.inductance_H[0]);
    CAPTURE(time_s);
    CHECK(two.current_A(0) == Approx(19.0 / seen_ohm * risen).epsilon(1e-3));
  }
  two.run_to(0.5);
  CHECK(two.current_A(0) == Approx(19.0 / seen_ohm).epsilon(1e-6));
  CHECK(two.current_A(2) == Approx(-19.0 / seen_ohm).epsilon(1e-6));
  DrivenCircuits one(rig);
  one.demand({10.0});
  one.run_to(0.5);
  CHECK(one.current_A(0) == Approx(19.0 / (1.9 + 0.2 * duty)).epsilon(1e-6));
  CHECK(one.current_A(0) > two.current_A(0) + 0.4);
}

TEST_CASE("duties and currents come in steps") {
  RigDescription rig = even_coils();
  rig.amplifier.duty_steps = 10;
  DrivenCircuits coarse(rig);
  coarse.demand({10.0, 0.0, -10.0, 0.0});  // a duty of 0.559
  CHECK(coarse.circuits[0].settled_current_A() == Approx(0.5 * 34.0 / 1.9));
  CHECK(coarse.circuits[2].settled_current_A() == Approx(-0.5 * 34.0 / 1.9));
  rig.amplifier.duty_steps = 32767;
  DrivenCircuits fine(rig);
  fine.demand({10.0});
  CHECK(fine.circuits[0].settled_current_A() <= 10.0);
  CHECK(fine.circuits[0].settled_current_A() > 10.0 - 34.0 / 1.9 / 32767.0);
  rig.amplifier.duty_steps = 0;
  rig.amplifier.current_step_A = 0.5;
  DrivenCircuits halves(rig);
  halves.demand({5.3, 0.0, -5.2, 0.0});
  CHECK(halves.circuits[0].settled_current_A() == Approx(5.5));
  CHECK(halves.circuits[2].settled_current_A() == Approx(-5.0));
}

TEST_CASE("a driver of currents gives a hot coil what a cold one gets, as far as the supply can push it") {
  RigDescription rig;
  rig.amplifier.controls = AmplifierControl::kCurrent;
  DrivenCircuits driven(rig);
  driven.circuits[0].set_state({0.0, 80.0, 0.0});
  driven.demand({8.0, 0.0, 8.0, 0.0});
  driven.run_to(0.003);  // all of the supply
  const double cold_ohm = driven.circuits[2].resistance_ohm();
  CHECK(driven.current_A(2) ==
        Approx(34.0 / cold_ohm * (1.0 - std::exp(-0.003 * cold_ohm / 17.6e-3))).epsilon(1e-4));
  CHECK(driven.current_A(0) < driven.current_A(2));
  driven.run_to(0.05);
  CHECK(driven.current_A(0) == Approx(8.0).epsilon(1e-5));
  CHECK(driven.current_A(2) == Approx(8.0).epsilon(1e-5));
  driven.off();
  driven.run_to(0.056);  // drawn out by the whole supply
  CHECK(std::abs(driven.current_A(0)) < 1e-6);
  CHECK(driven.amplifier.change_s() == Amplifier::kNever_s);

  DrivenCircuits far_too_hot(rig);
  far_too_hot.circuits[0].set_state({0.0, 150.0, 0.0});
  far_too_hot.demand({15.0});
  far_too_hot.run_to(0.2);
  CHECK(far_too_hot.current_A(0) == Approx(34.0 / far_too_hot.circuits[0].resistance_ohm()).epsilon(1e-3));
  CHECK(far_too_hot.current_A(0) < 12.5);

  rig.amplifier.controls = AmplifierControl::kDuty;
  DrivenCircuits by_duty(rig);
  by_duty.circuits[0].set_state({0.0, 80.0, 0.0});
  by_duty.demand({8.0});
  by_duty.run_to(0.05);
  CHECK(by_duty.current_A(0) < 6.7);
}

TEST_CASE("a driver of currents follows with its time constant") {
  RigDescription rig;
  rig.amplifier.controls = AmplifierControl::kCurrent;
  rig.amplifier.time_constant_s = 2e-3;
  DrivenCircuits driven(rig);
  driven.demand({3.0});
  for (const double time_s : {0.001, 0.002, 0.006}) {
    driven.run_to(time_s);
    CAPTURE(time_s);
    CHECK(driven.current_A(0) == Approx(3.0 * (1.0 - std::exp(-time_s / 2e-3))).epsilon(1e-5));
  }
}

TEST_CASE("a steady duty tells the resistance, and the coil then gets what it was asked for") {
  RigDescription rig;
  rig.amplifier.ramp_s = 0.05;
  rig.amplifier.resistance_after_s = 0.06;
  DrivenCircuits driven(rig);
  driven.circuits[0].set_state({0.0, 90.0, 0.0});
  const double warm = driven.circuits[0].resistance_ohm() / 1.9;
  driven.demand({8.0});
  driven.run_to(0.08);
  CHECK(driven.current_A(0) == Approx(8.0 / warm).epsilon(0.01));
  driven.run_to(0.3);
  CHECK(driven.current_A(0) == Approx(8.0).epsilon(5e-3));
  driven.off();
  driven.run_to(0.5);
  driven.demand({8.0});
  driven.run_to(0.58);  // nothing new has been told yet
  CHECK(driven.current_A(0) == Approx(8.0).epsilon(0.01));

  DrivenCircuits weak(rig);
  weak.circuits[0].set_state({0.0, 90.0, 0.0});
  weak.demand({0.5});
  weak.run_to(0.3);
  CHECK(weak.current_A(0) < 0.41);
}

TEST_CASE("drivers of two coils are told one after another, and only those of which something new is asked") {
  RigDescription rig = even_coils();
  rig.amplifier.axis_skew_s = 2e-3;
  DrivenCircuits both(rig);
  both.demand({5.0, 0.0, 5.0, 0.0});
  both.run_to(1.9e-3);
  CHECK(both.current_A(0) > 0.5);
  CHECK(both.current_A(2) == 0.0);
  both.run_to(3e-3);
  const double first_A = both.current_A(0);
  both.run_to(5e-3);
  CHECK(both.current_A(2) == Approx(first_A).epsilon(1e-9));
  DrivenCircuits second(rig);
  second.demand({0.0, 0.0, 5.0, 0.0});
  second.run_to(3e-3);
  CHECK(second.current_A(2) == Approx(first_A).epsilon(1e-9));
  // A command that was replaced on its way never arrives.
  DrivenCircuits stopped(rig);
  stopped.demand({5.0, 0.0, 5.0, 0.0});
  stopped.run_to(1e-3);
  stopped.off();
  for (const double time_s : {2.5e-3, 4e-3, 0.02}) {
    stopped.run_to(time_s);
    CHECK(stopped.current_A(2) == 0.0);
  }
  CHECK(stopped.current_A(0) > 0.0);
}

TEST_CASE("power stages of their own get no second ramp, but the same supply") {
  RigDescription rig = even_coils();
  rig.amplifier.ramp_s = 0.05;
  DrivenCircuits at_once(rig);
  at_once.amplifier.drive({0.5}, 34.0, 0.0, at_once.circuits);
  CHECK(at_once.circuits[0].state().duty == 0.5);
  CHECK(at_once.amplifier.change_s() == Amplifier::kNever_s);
  CHECK_FALSE(at_once.amplifier.stepwise());
  rig.supply_resistance_ohm = 0.2;
  DrivenCircuits sagging(rig);
  sagging.amplifier.drive({0.5}, 30.0, 0.0, sagging.circuits);
  CHECK(sagging.amplifier.stepwise());
  sagging.run_to(0.4);
  CHECK(sagging.current_A(0) == Approx(0.5 * 30.0 / (1.9 + 0.5 * 0.2)).epsilon(1e-6));
  sagging.amplifier.drive({}, 30.0, sagging.now_s, sagging.circuits);
  CHECK(sagging.circuits[0].state().duty == 0.0);
  CHECK(sagging.amplifier.change_s() == Amplifier::kNever_s);
}

TEST_CASE("drivers go on as they were saved, in the middle of a ramp") {
  RigDescription rig;
  rig.amplifier.ramp_s = 0.05;
  rig.amplifier.axis_skew_s = 2e-3;
  rig.amplifier.resistance_after_s = 0.03;
  rig.supply_resistance_ohm = 0.1;
  for (const double saved_s : {1e-3, 0.0123, 0.06}) {
    DrivenCircuits one(rig), other(rig);
    one.demand({6.0, 0.0, 0.0, -4.0});
    one.run_to(saved_s);
    const common::Json saved = common::Json::parse(one.amplifier.save().dump());
    other.amplifier.restore(saved);
    other.circuits = one.circuits;
    other.now_s = one.now_s;
    CHECK(other.amplifier.save() == one.amplifier.save());
    for (DrivenCircuits* each : {&one, &other}) {
      each->run_to(0.09);
      each->off();
      each->run_to(0.1);
    }
    CAPTURE(saved_s);
    CHECK(one.current_A(0) > 1.0);
    CHECK(one.current_A(0) == other.current_A(0));
    CHECK(one.current_A(3) == other.current_A(3));

    common::Json fewer = saved;
    fewer["outputs"].erase(std::size_t{0});
    CHECK_THROWS_WITH(other.amplifier.restore(fewer), Catch::Contains("3 outputs, this rig has 4 coils"));
    common::Json without = saved;
    without.erase("at_s");
    CHECK_THROWS_AS(other.amplifier.restore(without), common::Json::exception);
    CHECK(other.amplifier.save() == one.amplifier.save());
  }
}

TEST_CASE("circuits of which nothing else is known go on as they are driven") {
  RigDescription rig = even_coils();
  rig.amplifier.ramp_s = 0.05;
  DrivenCircuits driven(rig);
  driven.circuits[0].set_state({5.0, 22.0, 0.4});
  driven.amplifier.resume(0.0, Amplifier::kNever_s, driven.circuits);
  driven.run_to(0.2);
  CHECK(driven.current_A(0) == Approx(0.4 * 34.0 / 1.9).epsilon(1e-6));
  driven.off();
  driven.run_to(0.21);
  CHECK(driven.circuits[0].state().duty == Approx(0.2).margin(0.01));
  driven.run_to(0.4);
  CHECK(std::abs(driven.current_A(0)) < 1e-6);
}

}  // namespace
}  // namespace lodestone::physics
