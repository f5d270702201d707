#pragma once

#include "lodestone/physics/coils_description.h"
#include "lodestone/safety/check.h"
#include "lodestone/safety/thermal_model.h"

namespace lodestone::safety {

/// Faults that the device reports, coils that are too hot or would be after the pulse, and temperatures that
/// the pulses do not explain.
class TemperatureCheck final : public PulseCheck {
 public:
  /// `thermal` must outlive it, and is set to what is measured first.
  TemperatureCheck(double max_temperature_C, double tolerance_K, physics::CoilsDescription coils,
                   ThermalModel& thermal)
      : coils_(std::move(coils)),
        max_temperature_C_(max_temperature_C),
        tolerance_K_(tolerance_K),
        thermal_(thermal),
        known_(coils_.count(), false) {}
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;

 private:
  void check_measured(std::size_t coil, double measured_C, const rig::CoilPulse& last);

  physics::CoilsDescription coils_;
  double max_temperature_C_;
  double tolerance_K_;
  ThermalModel& thermal_;
  std::vector<bool> known_;
};

}  // namespace lodestone::safety
