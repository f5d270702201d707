#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::rig {

/// Coil order everywhere: +x, -x, +y, -y. Positive current makes a field that points from the dish centre
/// towards that coil.
constexpr int kCoilCount = 4;
constexpr const char* kCoilNames[kCoilCount] = {"+x", "-x", "+y", "-y"};

/// Four currents held for a time by the device itself.
struct CoilPulse {
  std::array<double, kCoilCount> current_A{};
  double duration_s = 0.0;
};

struct CoilStatus {
  std::array<double, kCoilCount> current_A{};      ///< measured
  std::array<double, kCoilCount> temperature_C{};  ///< measured or estimated
  std::optional<double> supply_V;                  ///< the lowest, where it is measured
  std::vector<std::string> faults;                 ///< empty when healthy
};

/// Four electromagnets. Implementations: the virtual rig's coils; the serial Arduino backend.
class Coils {
 public:
  virtual ~Coils() = default;
  /// Starts a pulse and returns; the device ends it after `duration_s`. A new pulse replaces the one before.
  /// Throws HardwareError when the device refuses it or does not answer.
  virtual void apply(const CoilPulse& pulse) = 0;
  /// Switches all coils off, now. Never throws, may be called at any time.
  virtual void stop() noexcept = 0;
  virtual CoilStatus status() = 0;
};

}  // namespace lodestone::rig
