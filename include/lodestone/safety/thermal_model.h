#pragma once

#include <array>

#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"

namespace lodestone::safety {

/// How warm the coils must be after the pulses that were asked for, each as a lump of copper:
/// C dT/dt = R(T) i^2 - k (T - T_ambient).
class ThermalModel {
 public:
  explicit ThermalModel(const physics::RigDescription& rig);

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
  double relaxed(const physics::CircuitConfig& coil, double temperature_C, double power_W,
                 double duration_s) const;
  std::array<physics::CircuitConfig, rig::kCoilCount> coils_;
  std::array<double, rig::kCoilCount> temperature_C_;
};

}  // namespace lodestone::safety
