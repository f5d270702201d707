#pragma once

namespace lodestone::physics {

/// Electrical and thermal side of one coil and its switching driver, as RigDescription::circuit() gives it.
struct CircuitConfig {
  double resistance_20C_ohm = 0.0;
  double inductance_H = 0.0;
  double supply_V = 0.0;
  double temperature_coefficient_per_K = 0.0;
  double heat_capacity_J_per_K = 0.0;
  double cooling_W_per_K = 0.0;
  double ambient_C = 0.0;
};

struct CircuitState {
  double current_A = 0.0;
  double temperature_C = 20.0;
  double duty = 0.0;  ///< signed fraction of the nominal supply
};

/// L di/dt = duty * supply - R(T) i. The driver knows R at 20 C only: duty = demand * R_20 / supply, clipped
/// to 1, so that a hot coil gives less current than demanded. Steps are exact for constant duty and
/// resistance; resistance follows the temperature from step to step.
class CoilCircuit {
 public:
  explicit CoilCircuit(const CircuitConfig& config);

  void demand(double current_A);
  /// A power stage of its own: a signed fraction of the supply that it has, which may have sagged.
  void drive(double duty, double supply_V) { state_.duty = duty * supply_V / config_.supply_V; }
  void off() { state_.duty = 0.0; }

  double resistance_ohm() const;
  /// Current that the present duty leads to at the present temperature.
  double settled_current_A() const;
  double time_constant_s() const;
  /// Current `after_s` from now at the present duty and resistance.
  double current_after_A(double after_s) const;
  /// Advances current and temperature; the heat is the exact integral of R i^2 over the step.
  void advance(double duration_s);

  const CircuitState& state() const { return state_; }
  void set_state(const CircuitState& state) { state_ = state; }

 private:
  CircuitConfig config_;
  CircuitState state_;
};

}  // namespace lodestone::physics
