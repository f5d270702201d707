#include "lodestone/rig/coil_measurement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"

namespace lodestone::rig {

namespace {

constexpr double kPulse_s = 0.2;
// As far from what is described as the firmware looks for a resistance, and how near that is one that it did
// not find.
constexpr double kLeastOfDescribed = 0.5, kMostOfDescribed = 2.0, kAtBound = 0.01;
constexpr double kFullRamp_s = 32767.0 / 655359.0;  // of the motor controllers, for the whole duty

/// Response of tau dI/dt + I = ramp, for an end value of 1.
double response(double t_s, double tau_s, double ramp_s) {
  if (t_s <= 0.0) return 0.0;
  const auto slope_part = [&](double t) { return (t - tau_s * (1.0 - std::exp(-t / tau_s))) / ramp_s; };
  return t_s <= ramp_s ? slope_part(t_s) : slope_part(t_s) - slope_part(t_s - ramp_s);
}

struct Candidate {
  double squares = std::numeric_limits<double>::infinity();
  double tau_s = 0.0;
  double t0_s = 0.0;
};

Candidate best_of(const CurrentTrace& trace, double ramp_s, double tau_low, double tau_high, double t0_low,
                  double t0_high) {
  constexpr int kGrid = 40;
  Candidate best;
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; j <= kGrid; ++j) {
      const double tau_s = tau_low + (tau_high - tau_low) * i / kGrid;
      const double t0_s = t0_low + (t0_high - t0_low) * j / kGrid;
      double model2 = 0.0;
      double cross = 0.0;
      double data2 = 0.0;
      for (const auto& [t_s, current_A] : trace.samples) {
        const double model = response(t_s - t0_s, tau_s, ramp_s);
        model2 += model * model;
        cross += model * current_A;
        data2 += current_A * current_A;
      }
      if (model2 <= 0.0) continue;
      const double squares = data2 - cross * cross / model2;
      if (squares < best.squares) best = {squares, tau_s, t0_s};
    }
  }
  return best;
}

}  // namespace

CoilMeasurement fit_rise(const CurrentTrace& trace, double ramp_s) {
  if (trace.samples.size() < 6)
    throw common::DataError("a rise of current needs at least 6 samples, there are " +
                            std::to_string(trace.samples.size()));
  double largest_A = 0.0;
  for (const auto& sample : trace.samples) largest_A = std::max(largest_A, std::abs(sample.second));
  if (largest_A < 0.1) throw common::DataError("no current rose in the coil: is it connected?");
  double tau_low = 1e-4;
  double tau_high = 0.1;
  double t0_low = 0.0;
  double t0_high = 0.02;
  Candidate best;
  for (int round = 0; round < 4; ++round) {
    best = best_of(trace, std::max(ramp_s, 1e-6), tau_low, tau_high, t0_low, t0_high);
    const double tau_span = (tau_high - tau_low) / 10.0;
    const double t0_span = (t0_high - t0_low) / 10.0;
    tau_low = std::max(1e-5, best.tau_s - tau_span);
    tau_high = best.tau_s + tau_span;
    t0_low = best.t0_s - t0_span;
    t0_high = best.t0_s + t0_span;
  }
  CoilMeasurement found;
  found.time_constant_s = best.tau_s;
  found.rms_A = std::sqrt(std::max(0.0, best.squares) / static_cast<double>(trace.samples.size()));
  return found;
}

CoilMeasurement measure_coil(SerialCoils& coils, Coils& guarded, int coil, double current_A, int pulses,
                             const std::function<void(double seconds)>& rest) {
  std::vector<CoilMeasurement> found;
  const auto index = static_cast<std::size_t>(coil);
  const double described_ohm = coils.description().resistance_20C_ohm[index];
  const bool bipolar = coils.description().smallest_A(index) < 0.0;
  for (int i = 0; i < pulses; ++i) {
    CoilPulse pulse;
    pulse.current_A[index] = bipolar && i % 2 != 0 ? -current_A : current_A;
    pulse.duration_s = kPulse_s;
    guarded.apply(pulse);
    rest(2.5 * kPulse_s);
    const CoilControllerState state = coils.state();
    if (!state.faults.empty())
      throw common::HardwareError(
          fmt::format("measuring stopped: {} (a coil counts as too hot, too, where it has far more than the "
                      "{:g} ohm that are described: rig.coils.resistance_20C_ohm)",
                      state.faults.front(), described_ohm));
    const double resistance_ohm = state.resistance_ohm[index];
    if (resistance_ohm < (1.0 + kAtBound) * kLeastOfDescribed * described_ohm ||
        resistance_ohm > (1.0 - kAtBound) * kMostOfDescribed * described_ohm)
      throw common::HardwareError(fmt::format(
          "coil {} has less than half or more than twice the {:g} ohm that are described, which is as far as "
          "the firmware looks: describe it nearer (rig.coils.resistance_20C_ohm) and measure again",
          coils.description().name(index), described_ohm));
    const double supply_V = state.supply_V[coils.controller_of(index)];
    const double duty = std::min(1.0, std::abs(current_A) * resistance_ohm / std::max(1.0, supply_V));
    CoilMeasurement one = fit_rise(coils.trace(), duty * kFullRamp_s);
    one.resistance_ohm = resistance_ohm;
    found.push_back(one);
  }
  const auto middle = [&](auto value) {
    std::vector<double> values;
    for (const CoilMeasurement& one : found) values.push_back(value(one));
    return common::median(std::move(values));
  };
  CoilMeasurement median;
  median.resistance_ohm = middle([](const CoilMeasurement& one) { return one.resistance_ohm; });
  median.time_constant_s = middle([](const CoilMeasurement& one) { return one.time_constant_s; });
  median.rms_A = middle([](const CoilMeasurement& one) { return one.rms_A; });
  return median;
}

}  // namespace lodestone::rig
