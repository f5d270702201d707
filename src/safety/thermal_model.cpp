#include "lodestone/safety/thermal_model.h"

#include <cmath>
#include <cstddef>

namespace lodestone::safety {

ThermalModel::ThermalModel(const ThermalConfig& config) : config_(config) {
  temperature_C_.fill(config.ambient_C);
}

double ThermalModel::power_W(int coil, double current_A) const {
  const double warmer_K = temperature_C_[static_cast<std::size_t>(coil)] - 20.0;
  return config_.resistance_20C_ohm * (1.0 + config_.temperature_coefficient_per_K * warmer_K) * current_A *
         current_A;
}

/// Exact for constant power.
double ThermalModel::relaxed(double temperature_C, double power_W, double duration_s) const {
  if (config_.cooling_W_per_K <= 0.0)
    return temperature_C + power_W * duration_s / config_.heat_capacity_J_per_K;
  const double final_C = config_.ambient_C + power_W / config_.cooling_W_per_K;
  return final_C + (temperature_C - final_C) *
                       std::exp(-duration_s * config_.cooling_W_per_K / config_.heat_capacity_J_per_K);
}

double ThermalModel::after_pulse_C(int coil, double current_A, double duration_s) const {
  return relaxed(temperature_C_[static_cast<std::size_t>(coil)], power_W(coil, current_A), duration_s);
}

void ThermalModel::advance(const std::array<double, rig::kCoilCount>& current_A, double on_s,
                           double total_s) {
  for (std::size_t i = 0; i < temperature_C_.size(); ++i) {
    temperature_C_[i] = after_pulse_C(static_cast<int>(i), current_A[i], on_s);
    temperature_C_[i] = relaxed(temperature_C_[i], 0.0, total_s - on_s);
  }
}

}  // namespace lodestone::safety
