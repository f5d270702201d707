#pragma once

#include <deque>
#include <optional>

#include "lodestone/common/clock.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/control/guard.h"
#include "lodestone/physics/four_coils.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::console {

/// Stands between the control loop and what guards its coils, and remembers the pulses of the last seconds:
/// what is on, how much of the time each coil was, how evenly pulses come. What it remembers may be asked for
/// from any thread.
class PulseLog final : public control::Guard {
 public:
  static constexpr double kWindow_s = 10.0;

  /// Both must outlive the log. `period_s`: how far apart pulses should be.
  PulseLog(control::Guard& guard, const common::Clock& clock, double period_s, std::size_t coils)
      : guard_(guard), clock_(clock), period_s_(period_s), coils_(coils) {}

  void begin_step(double due_s) override { guard_.begin_step(due_s); }
  void observe(const control::PoseEstimate& estimate) override { guard_.observe(estimate); }
  void apply(const rig::CoilPulse& pulse) override;
  void probe(const rig::CoilPulse& pulse) override;
  void stop() noexcept override;

  /// What is on now, as asked.
  physics::PerCoil on_A(double now_s) const;
  /// Fraction of the last kWindow_s that each coil was on.
  physics::PerCoil duty(double now_s) const;
  /// By how much the time between the last two pulses was off; nothing before there are two of one run.
  std::optional<double> jitter_s() const;
  /// A run begins: what follows is no interval.
  void begin_run();

 private:
  struct Logged {
    rig::CoilPulse pulse;
    double start_s;
  };
  void note(const rig::CoilPulse& pulse, double start_s);

  control::Guard& guard_;
  const common::Clock& clock_;
  double period_s_;
  std::size_t coils_;
  mutable common::PriorityMutex mutex_;
  std::deque<Logged> pulses_;
  std::optional<double> last_s_, interval_s_;
};

}  // namespace lodestone::console
