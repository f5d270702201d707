#pragma once

#include <array>

#include "lodestone/common/config.h"
#include "lodestone/rig/coils.h"

namespace lodestone::safety {

/// A coil as a lump of copper: C dT/dt = R(T) i^2 - k (T - T_ambient). Defaults: docs of the virtual rig.
struct ThermalConfig {
  double resistance_20C_ohm = 1.90;
  double temperature_coefficient_per_K = 3.9e-3;
  double heat_capacity_J_per_K = 651.0;
  double cooling_W_per_K = 15.0;
  double ambient_C = 22.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("resistance_20C_ohm", resistance_20C_ohm, "ohm", "resistance of a coil at 20 C", {1e-3, 1e4});
    v.field("temperature_coefficient_per_K", temperature_coefficient_per_K, "1/K",
            "relative change of resistance", {0.0, 0.02});
    v.field("heat_capacity_J_per_K", heat_capacity_J_per_K, "J/K", "heat capacity of a coil", {0.1, 1e6});
    v.field("cooling_W_per_K", cooling_W_per_K, "W/K", "heat lost per degree above ambient", {0.0, 1e4});
    v.field("ambient_C", ambient_C, "C", "room temperature; coils start there", {-20.0, 60.0});
  }
};

/// How warm the coils must be after the pulses that were asked for.
class ThermalModel {
 public:
  explicit ThermalModel(const ThermalConfig& config);

  /// Time passes: `on_s` of it with these currents.
  void advance(const std::array<double, rig::kCoilCount>& current_A, double on_s, double total_s);
  /// Electrical power of a coil at its present temperature, W.
  double power_W(int coil, double current_A) const;
  /// What a pulse would lead to, C.
  double after_pulse_C(int coil, double current_A, double duration_s) const;

  double temperature_C(int coil) const { return temperature_C_[static_cast<std::size_t>(coil)]; }
  /// A measurement to go on from.
  void set_temperature_C(int coil, double temperature_C) {
    temperature_C_[static_cast<std::size_t>(coil)] = temperature_C;
  }

 private:
  double relaxed(double temperature_C, double power_W, double duration_s) const;
  ThermalConfig config_;
  std::array<double, rig::kCoilCount> temperature_C_;
};

}  // namespace lodestone::safety
