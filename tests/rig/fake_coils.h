#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/rig/coils.h"

namespace lodestone::tests {

/// Time that only sleeping moves.
class FakeRigClock final : public common::Clock {
 public:
  double now_s() const override { return now_s_; }
  bool wait_until(double time_s, common::Interruption* interruption) override {
    if (interruption != nullptr && interruption->raised()) return false;
    now_s_ = time_s > now_s_ ? time_s : now_s_;
    return true;
  }

 private:
  double now_s_ = 0.0;
};

/// Ideal coils on a clock: they remember every pulse, and the current is there at once until the pulse ends.
class FakeCoils final : public rig::Coils {
 public:
  explicit FakeCoils(const common::Clock& clock, double max_current_A = 15.0)
      : clock_(clock), max_current_A_(max_current_A) {}

  void apply(const rig::CoilPulse& pulse) override {
    for (const double current : pulse.current_A) {
      if (!(std::abs(current) <= max_current_A_)) {
        throw common::HardwareError("fake coils: current " + std::to_string(current) + " A is beyond +-" +
                                    std::to_string(max_current_A_) + " A");
      }
    }
    if (!(pulse.duration_s >= 0.0 && std::isfinite(pulse.duration_s))) {
      throw common::HardwareError("fake coils: duration " + std::to_string(pulse.duration_s) +
                                  " s is refused");
    }
    pulses.push_back(pulse);
    end_s_ = clock_.now_s() + pulse.duration_s;
    on_ = true;
  }
  void stop() noexcept override {
    ++stops;
    on_ = false;
  }
  rig::CoilStatus status() override {
    rig::CoilStatus status;
    if (on_ && clock_.now_s() < end_s_) status.current_A = pulses.back().current_A;
    status.temperature_C.assign(4, 20.0);
    return status;
  }

  std::vector<rig::CoilPulse> pulses;
  int stops = 0;

 private:
  const common::Clock& clock_;
  double max_current_A_;
  double end_s_ = 0.0;
  bool on_ = false;
};

}  // namespace lodestone::tests
