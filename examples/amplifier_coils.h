// rig::Coils on a driver of your own, here the made-up one of amplifier.h: amperes to its units, its refusals
// to errors, every pulse to a log. Hold yours against tests/rig/coils_conformance.h. How to drive with it:
// own_coils.cpp.
#pragma once

#include <array>
#include <cmath>
#include <ostream>
#include <string>

#include "amplifier.h"
#include "lodestone/common/error.h"
#include "lodestone/rig/coils.h"

class AmplifierCoils final : public lodestone::rig::Coils {
 public:
  /// Both must outlive it. The log gets a line of currents in A and the duration in s for each pulse.
  AmplifierCoils(vendor::Amplifier& amplifier, std::ostream& log) : amplifier_(amplifier), log_(log) {
    log_ << "current_px_A,current_mx_A,current_py_A,current_my_A,duration_s\n";
  }

  void apply(const lodestone::rig::CoilPulse& pulse) override {
    std::array<int, vendor::Amplifier::kChannels> current_mA;
    for (std::size_t coil = 0; coil < vendor::Amplifier::kChannels; ++coil)
      current_mA[kChannel[coil]] = thousandths(pulse.current_A[coil]);
    if (!amplifier_.pulse(current_mA, thousandths(pulse.duration_s)))
      throw lodestone::common::HardwareError(
          "amplifier: it refuses a pulse; see its limits of current and duration");
    for (std::size_t coil = 0; coil < vendor::Amplifier::kChannels; ++coil)
      log_ << pulse.current_A[coil] << ',';
    log_ << pulse.duration_s << '\n';
  }

  void stop() noexcept override { amplifier_.off(); }

  lodestone::rig::CoilStatus status() override {
    lodestone::rig::CoilStatus status;
    for (std::size_t coil = 0; coil < vendor::Amplifier::kChannels; ++coil) {
      status.current_A[coil] = 1e-3 * amplifier_.current_mA()[kChannel[coil]];
      status.temperature_C[coil] = amplifier_.temperature_C()[kChannel[coil]];
    }
    if (const std::string alarm = amplifier_.alarm(); !alarm.empty()) status.faults.push_back(alarm);
    return status;
  }

 private:
  static constexpr int kChannel[] = {0, 2, 1, 3};  // of the coils +x, -x, +y, -y

  static int thousandths(double number) {
    if (!(std::abs(number) < 1e6))
      throw lodestone::common::HardwareError("amplifier: " + std::to_string(number) + " A or s");
    return static_cast<int>(std::lround(1e3 * number));
  }

  vendor::Amplifier& amplifier_;
  std::ostream& log_;
};
