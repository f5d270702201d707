#pragma once

#include "lodestone/rig/serial_coils.h"

namespace lodestone::rig {

/// What one coil is, electrically.
struct CoilMeasurement {
  double resistance_ohm = 0.0;
  double time_constant_s = 0.0;  ///< L/R
  double rms_A = 0.0;            ///< of the rise against the fit
  double inductance_H() const { return resistance_ohm * time_constant_s; }
};

/// Fits I(t) of a coil behind a voltage that rises evenly for `ramp_s` and then stays:
/// tau dI/dt + I = I_end min(1, (t - t0)/ramp_s). Unknown are tau, t0 and I_end. Throws DataError when there
/// are fewer than six samples or no rise among them.
CoilMeasurement fit_rise(const CurrentTrace& trace, double ramp_s);

/// Sends pulses through one coil, long enough for its resistance to be told, and fits their rise; the median
/// of `pulses`. The needle will move. `rest` waits between them. Throws HardwareError and DataError.
CoilMeasurement measure_coil(SerialCoils& coils, Coils& guarded, int coil, double current_A, int pulses,
                             const std::function<void(double seconds)>& rest);

}  // namespace lodestone::rig
