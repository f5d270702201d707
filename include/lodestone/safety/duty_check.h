#pragma once

#include <utility>

#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// Coils that are on for too large a fraction of the time.
class DutyCheck final : public PulseCheck {
 public:
  DutyCheck(double max_duty, double window_s, physics::CoilsDescription coils)
      : max_duty_(max_duty), window_s_(window_s), coils_(std::move(coils)), on_level_s_(coils_.count()) {}
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;

 private:
  double max_duty_;
  double window_s_;
  physics::CoilsDescription coils_;
  physics::PerCoil on_level_s_;  // leaky count of time switched on
};

}  // namespace lodestone::safety
