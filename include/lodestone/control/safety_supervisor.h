#pragma once

#include <cstdint>
#include <string>

#include "lodestone/rig/coils.h"

namespace lodestone::control {

/// What the coils may be asked for.
struct SafetyConfig {
  double max_current_A = 15.0;
  double max_pulse_s = 0.25;
  double max_temperature_C = 90.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_current_A", max_current_A, "A", "currents are limited to this", {0.0, 100.0});
    v.field("max_pulse_s", max_pulse_s, "s", "pulses are limited to this", {0.0, 10.0});
    v.field("max_temperature_C", max_temperature_C, "C", "a coil above this stops the run", {0.0, 300.0});
  }
};

/// Stands in front of every Coils: limits current and pulse length; on NaN, opposite coils driven together, a
/// fault in the status or a hot coil it stops all coils, keeps the reason, and refuses every pulse after
/// that.
class SafetySupervisor final : public rig::Coils {
 public:
  SafetySupervisor(rig::Coils& coils, const SafetyConfig& config) : coils_(coils), config_(config) {}

  /// Throws HardwareError with the reason when the pulse is refused.
  void apply(const rig::CoilPulse& pulse) override;
  void stop() noexcept override { coils_.stop(); }
  rig::CoilStatus status() override { return coils_.status(); }

  bool latched() const { return !reason_.empty(); }
  const std::string& reason() const { return reason_; }
  /// Pulses that were cut to a limit.
  std::int64_t limited() const { return limited_; }

 private:
  [[noreturn]] void latch(const std::string& reason);

  rig::Coils& coils_;
  SafetyConfig config_;
  std::string reason_;
  std::int64_t limited_ = 0;
};

}  // namespace lodestone::control
