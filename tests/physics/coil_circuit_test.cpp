#include "lodestone/physics/coil_circuit.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {
namespace {

CircuitConfig at_20C() {
  CircuitConfig config = RigDescription{}.circuit(0);
  config.ambient_C = 20.0;
  return config;
}

TEST_CASE("current rises with L/R and falls likewise") {
  CircuitConfig config = at_20C();
  config.temperature_coefficient_per_K = 0.0;
  CoilCircuit coil(config);
  const double tau = config.inductance_H / config.resistance_20C_ohm;
  CHECK(tau == Approx(9.26e-3).epsilon(1e-3));
  coil.demand(10.0);
  CHECK(coil.current_after_A(tau) == Approx(10.0 * (1.0 - std::exp(-1.0))));
  for (int i = 0; i < 7; ++i) coil.advance(tau / 7.0);
  CHECK(coil.state().current_A == Approx(10.0 * (1.0 - std::exp(-1.0))).epsilon(1e-12));
  coil.advance(1.0);
  CHECK(coil.state().current_A == Approx(10.0).epsilon(1e-12));
  coil.off();
  coil.advance(2.0 * tau);
  CHECK(coil.state().current_A == Approx(10.0 * std::exp(-2.0)).epsilon(1e-12));
  coil.advance(10.0);
  CHECK(coil.state().current_A == 0.0);
}

TEST_CASE("the supply limits the current") {
  CoilCircuit coil(at_20C());
  coil.demand(1000.0);
  CHECK(coil.state().duty == 1.0);
  CHECK(coil.settled_current_A() == Approx(34.0 / 1.90));
  coil.demand(-1000.0);
  CHECK(coil.settled_current_A() == Approx(-34.0 / 1.90));
}

TEST_CASE("a hot coil gives less current than demanded") {
  CoilCircuit coil(at_20C());
  coil.set_state({0.0, 70.0, 0.0});
  coil.demand(10.0);
  CHECK(coil.settled_current_A() == Approx(10.0 / (1.0 + 3.9e-3 * 50.0)));
}

TEST_CASE("heat is the energy from the supply less what the inductance holds") {
  CircuitConfig config = at_20C();
  config.cooling_W_per_K = 0.0;
  config.temperature_coefficient_per_K = 0.0;
  CoilCircuit coil(config);
  coil.demand(15.0);
  double supplied_J = 0.0;
  const int steps = 20000;
  const double h = 0.05 / steps;
  for (int i = 0; i < steps; ++i) {
    supplied_J += h * 15.0 * config.resistance_20C_ohm * coil.current_after_A(h / 2.0);
    coil.advance(h);
  }
  const double stored_J = 0.5 * config.inductance_H * coil.state().current_A * coil.state().current_A;
  CHECK(config.heat_capacity_J_per_K * (coil.state().temperature_C - 20.0) ==
        Approx(supplied_J - stored_J).epsilon(1e-6));
  // One exact step is the same as many.
  CoilCircuit once(config);
  once.demand(15.0);
  once.advance(0.05);
  CHECK(once.state().temperature_C == Approx(coil.state().temperature_C).epsilon(1e-9));
}

TEST_CASE("a coil cools to ambient with its thermal time constant") {
  const CircuitConfig config = at_20C();
  CoilCircuit coil(config);
  coil.set_state({0.0, 80.0, 0.0});
  const double tau = config.heat_capacity_J_per_K / config.cooling_W_per_K;
  for (int i = 0; i < 10; ++i) coil.advance(tau / 10.0);
  CHECK(coil.state().temperature_C == Approx(20.0 + 60.0 * std::exp(-1.0)).epsilon(1e-9));
}

}  // namespace
}  // namespace lodestone::physics
