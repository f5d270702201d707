#include "lodestone/physics/coil_circuit.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/saturation.h"

namespace lodestone::physics {

CoilCircuit::CoilCircuit(const CircuitConfig& config) : config_(config) {
  state_.temperature_C = config.ambient_C;
}

void CoilCircuit::demand(double current_A) {
  state_.duty = geometry::saturated(current_A * config_.resistance_20C_ohm / config_.supply_V);
}

double CoilCircuit::resistance_ohm() const {
  return config_.resistance_20C_ohm *
         (1.0 + config_.temperature_coefficient_per_K * (state_.temperature_C - 20.0));
}

double CoilCircuit::settled_current_A() const { return state_.duty * config_.supply_V / resistance_ohm(); }

double CoilCircuit::time_constant_s() const { return config_.inductance_H / resistance_ohm(); }

double CoilCircuit::current_after_A(double after_s) const {
  const double settled = settled_current_A();
  return settled + (state_.current_A - settled) * std::exp(-after_s / time_constant_s());
}

void CoilCircuit::advance(double duration_s) {
  if (duration_s <= 0.0) return;
  const double tau = time_constant_s();
  const double settled = settled_current_A();
  const double excess = state_.current_A - settled;
  const double decay = std::exp(-duration_s / tau);
  const double square_integral = settled * settled * duration_s +
                                 2.0 * settled * excess * tau * (1.0 - decay) +
                                 0.5 * excess * excess * tau * (1.0 - decay * decay);
  const double power_W = resistance_ohm() * square_integral / duration_s;
  double current = settled + excess * decay;
  // A current that has faded is zero: denormal numbers would slow every later step.
  if (std::abs(current) < 1e-12) current = 0.0;
  if (config_.cooling_W_per_K > 0.0) {
    const double final_C = config_.ambient_C + power_W / config_.cooling_W_per_K;
    state_.temperature_C =
        final_C + (state_.temperature_C - final_C) *
                      std::exp(-duration_s * config_.cooling_W_per_K / config_.heat_capacity_J_per_K);
  } else {
    state_.temperature_C += power_W * duration_s / config_.heat_capacity_J_per_K;
  }
  state_.current_A = current;
}

}  // namespace lodestone::physics
