#pragma once

#include <functional>
#include <vector>

#include "lodestone/common/clock.h"

namespace lodestone::tests {

/// Runs only as far as it is let.
class StepClock final : public common::Clock {
 public:
  double now_s() const override { return 50.0; }
  bool wait_until(double time_s, common::Interruption* interruption) override {
    if (interruption != nullptr && interruption->raised()) return false;
    waits.push_back(time_s - 50.0);
    if (look) look();
    return true;
  }
  std::vector<double> waits;
  std::function<void()> look;
};

}  // namespace lodestone::tests
