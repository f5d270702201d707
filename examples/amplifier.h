// The driver of a made-up amplifier, as a vendor might ship one: whole milliamperes and milliseconds,
// channels in an order of its own, answers instead of exceptions. Its wires lead to the coils of the virtual
// rig. See own_coils.cpp.
#pragma once

#include <array>
#include <string>

#include "lodestone/common/error.h"
#include "lodestone/rig/coils.h"

namespace vendor {

class Amplifier {
 public:
  static constexpr int kChannels = 4;  // +x, +y, -x, -y

  explicit Amplifier(lodestone::rig::Coils& wires) : wires_(wires) {}

  /// False where the device refuses it.
  bool pulse(const std::array<int, kChannels>& current_mA, int duration_ms) {
    try {
      wires_.apply({{1e-3 * current_mA[0], 1e-3 * current_mA[2], 1e-3 * current_mA[1], 1e-3 * current_mA[3]},
                    1e-3 * duration_ms});
      return true;
    } catch (const lodestone::common::HardwareError&) {
      return false;
    }
  }
  void off() noexcept { wires_.stop(); }

  std::array<int, kChannels> current_mA() {
    const auto A = wires_.status().current_A;
    return {whole(1e3 * A[0]), whole(1e3 * A[2]), whole(1e3 * A[1]), whole(1e3 * A[3])};
  }
  std::array<double, kChannels> temperature_C() {
    const auto C = wires_.status().temperature_C;
    return {C[0], C[2], C[1], C[3]};
  }
  /// Empty while all is well.
  std::string alarm() {
    const auto faults = wires_.status().faults;
    return faults.empty() ? "" : "amplifier alarm: " + faults.front();
  }

 private:
  static int whole(double number) { return static_cast<int>(number < 0.0 ? number - 0.5 : number + 0.5); }

  lodestone::rig::Coils& wires_;
};

}  // namespace vendor
