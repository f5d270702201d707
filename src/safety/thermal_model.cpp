#include "lodestone/safety/thermal_model.h"

#include <cmath>
#include <cstddef>

namespace lodestone::safety {

ThermalModel::ThermalModel(const physics::RigDescription& rig) {
  for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) coils_.push_back(rig.circuit(coil));
  temperature_C_.assign(coils_.size(), rig.ambient_C);
}

double ThermalModel::power_W(std::size_t coil, double current_A) const {
  const double warmer_K = temperature_C_[coil] - 20.0;
  return coils_[coil].resistance_20C_ohm * (1.0 + coils_[coil].temperature_coefficient_per_K * warmer_K) *
         current_A * current_A;
}

/// Exact for constant power.
double ThermalModel::relaxed(const physics::CircuitConfig& coil, double temperature_C, double power_W,
                             double duration_s) const {
  if (coil.cooling_W_per_K <= 0.0) return temperature_C + power_W * duration_s / coil.heat_capacity_J_per_K;
  const double final_C = coil.ambient_C + power_W / coil.cooling_W_per_K;
  return final_C + (temperature_C - final_C) *
                       std::exp(-duration_s * coil.cooling_W_per_K / coil.heat_capacity_J_per_K);
}

double ThermalModel::after_pulse_C(std::size_t coil, double current_A, double duration_s) const {
  return relaxed(coils_[coil], temperature_C_[coil], power_W(coil, current_A), duration_s);
}

void ThermalModel::advance(const physics::PerCoil& current_A, double on_s, double total_s) {
  for (std::size_t i = 0; i < temperature_C_.size(); ++i) {
    temperature_C_[i] = after_pulse_C(i, current_A[i], on_s);
    temperature_C_[i] = relaxed(coils_[i], temperature_C_[i], 0.0, total_s - on_s);
  }
}

}  // namespace lodestone::safety
