#pragma once

#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"

namespace lodestone::safety {

/// How warm the coils must be after the pulses that were asked for, each as a lump of copper:
/// C dT/dt = R(T) i^2 - k (T - T_ambient).
class ThermalModel {
 public:
  explicit ThermalModel(const physics::RigDescription& rig);

  /// Time passes: `on_s` of it with these currents.
  void advance(const physics::PerCoil& current_A, double on_s, double total_s);
  /// Electrical power of a coil at its present temperature, W.
  double power_W(std::size_t coil, double current_A) const;
  /// What a pulse would lead to, C.
  double after_pulse_C(std::size_t coil, double current_A, double duration_s) const;

  double temperature_C(std::size_t coil) const { return temperature_C_[coil]; }
  /// A measurement to go on from.
  void set_temperature_C(std::size_t coil, double temperature_C) { temperature_C_[coil] = temperature_C; }

 private:
  double relaxed(const physics::CircuitConfig& coil, double temperature_C, double power_W,
                 double duration_s) const;
  std::vector<physics::CircuitConfig> coils_;
  physics::PerCoil temperature_C_;
};

}  // namespace lodestone::safety
