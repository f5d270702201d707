#pragma once

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// Faults that the device itself reports.
class DeviceCheck final : public PulseCheck {
 public:
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;
};

}  // namespace lodestone::safety
