#include "lodestone/safety/thermal_model.h"

#include <cmath>
#include <cstddef>

namespace lodestone::safety {

ThermalModel::ThermalModel(const physics::RigDescription& rig) {
  for (std::size_t i = 0; i < coils_.size(); ++i) coils_[i] = rig.circuit(static_cast<int>(i));
  temperature_C_.fill(rig.ambient_C);
}

double ThermalModel::power_W(int coil, double current_A) const {
  const auto index = static_cast<std::size_t>(coil);
  const double warmer_K = temperature_C_[index] - 20.0;
  return coils_[index].resistance_20C_ohm * (1.0 + coils_[index].temperature_coefficient_per_K * warmer_K) *
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

double ThermalModel::after_pulse_C(int coil, double current_A, double duration_s) const {
  const auto index = static_cast<std::size_t>(coil);
  return relaxed(coils_[index], temperature_C_[index], power_W(coil, current_A), duration_s);
}

void ThermalModel::advance(const std::array<double, rig::kCoilCount>& current_A, double on_s,
                           double total_s) {
  for (std::size_t i = 0; i < temperature_C_.size(); ++i) {
    temperature_C_[i] = after_pulse_C(static_cast<int>(i), current_A[i], on_s);
    temperature_C_[i] = relaxed(coils_[i], temperature_C_[i], 0.0, total_s - on_s);
  }
}

}  // namespace lodestone::safety
