#pragma once

#include "lodestone/physics/coils_description.h"
#include "lodestone/safety/check.h"
#include "lodestone/safety/thermal_model.h"

namespace lodestone::safety {

/// Cuts currents, power and pulse length to their limits. Refuses numbers that are none, and coils
/// together of which only one may be on.
class PulseLimits final : public PulseCheck {
 public:
  /// `thermal` must outlive it: power is that of the coils as warm as they are.
  PulseLimits(double max_current_A, double max_power_W, double max_pulse_s, physics::CoilsDescription coils,
              const ThermalModel& thermal)
      : coils_(std::move(coils)),
        max_current_A_(max_current_A),
        max_power_W_(max_power_W),
        max_pulse_s_(max_pulse_s),
        thermal_(thermal) {}
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;

 private:
  void keep_direction(rig::CoilPulse& pulse) const;

  physics::CoilsDescription coils_;
  double max_current_A_;
  double max_power_W_;
  double max_pulse_s_;
  const ThermalModel& thermal_;
};

}  // namespace lodestone::safety
