#pragma once

namespace lodestone::physics {

/// Electrical and thermal side of one coil and its switching driver.
struct CircuitConfig {
  double resistance_20C_ohm = 1.90;               // D: 560 turns of AWG16 on the default winding
  double inductance_H = 17.6e-3;                  // D: L/R = 9.3 ms
  double supply_V = 34.0;                         // D
  double temperature_coefficient_per_K = 3.9e-3;  // I: copper
  double heat_capacity_J_per_K = 651.0;           // I: mass of copper
  double cooling_W_per_K = 15.0;                  // D: thermal time constant about 45 s
  double ambient_C = 22.0;                        // D

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("resistance_20C_ohm", resistance_20C_ohm, "ohm", "resistance of a coil at 20 C", {1e-3, 1e4});
    v.field("inductance_H", inductance_H, "H", "inductance of a coil", {1e-9, 10.0});
    v.field("supply_V", supply_V, "V", "supply that the driver switches", {0.1, 1000.0});
    v.field("temperature_coefficient_per_K", temperature_coefficient_per_K, "1/K",
            "relative change of resistance", {0.0, 0.02});
    v.field("heat_capacity_J_per_K", heat_capacity_J_per_K, "J/K", "heat capacity of a coil", {0.1, 1e6});
    v.field("cooling_W_per_K", cooling_W_per_K, "W/K", "heat lost per degree above ambient", {0.0, 1e4});
    v.field("ambient_C", ambient_C, "C", "room temperature; coils start there", {-20.0, 60.0});
  }
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
