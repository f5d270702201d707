#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/physics/per_coil.h"

namespace lodestone::rig {

/// Currents held for a time by the device itself. The order of the coils is everywhere that of the
/// description, for the paper's rig +x, -x, +y, -y.
struct CoilPulse {
  physics::PerCoil current_A{};
  double duration_s = 0.0;
};

struct CoilStatus {
  physics::PerCoil current_A{};      ///< measured
  physics::PerCoil temperature_C{};  ///< measured or estimated
  std::optional<double> supply_V;    ///< the lowest, where it is measured
  std::vector<std::string> faults;   ///< empty when healthy
};

/// Electromagnets. Implementations: the virtual rig's coils; the serial Arduino backend.
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
