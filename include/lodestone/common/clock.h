#pragma once

#include "lodestone/common/interruption.h"

namespace lodestone::common {

/// Time as the control loop sees it. Real rigs use SteadyClock; the virtual rig's own clock advances its
/// physics.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Seconds since an arbitrary start; never goes back.
  virtual double now_s() const = 0;
  /// Returns true once now_s() >= time_s, at once when that is past; false as soon as `interruption`, where
  /// there is one, is raised.
  virtual bool wait_until(double time_s, Interruption* interruption) = 0;
  /// Whether its time passes by itself: who waits too long is late.
  virtual bool passes_by_itself() const { return false; }
  void sleep_until(double time_s) { wait_until(time_s, nullptr); }
};

/// The monotonic wall clock.
class SteadyClock final : public Clock {
 public:
  double now_s() const override;
  bool wait_until(double time_s, Interruption* interruption) override;
  bool passes_by_itself() const override { return true; }
};

/// Seconds since 1970 by the clock of the system, which somebody may set.
double unix_time_s();

}  // namespace lodestone::common
