#pragma once

#include <array>

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// Coils that are on for too large a fraction of the time.
class DutyCheck final : public PulseCheck {
 public:
  DutyCheck(double max_duty, double window_s) : max_duty_(max_duty), window_s_(window_s) {}
  void check(rig::CoilPulse& pulse, const PulseContext& context) override;

 private:
  double max_duty_;
  double window_s_;
  std::array<double, rig::kCoilCount> on_level_s_{};  // leaky count of time switched on
};

}  // namespace lodestone::safety
