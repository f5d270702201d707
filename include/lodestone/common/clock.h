#pragma once

namespace lodestone::common {

/// Time as the control loop sees it. Real rigs use SteadyClock; the virtual rig's own clock advances its
/// physics.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Seconds since an arbitrary start; never goes back.
  virtual double now_s() const = 0;
  /// Returns once now_s() >= time_s; at once when that is past.
  virtual void sleep_until(double time_s) = 0;
};

/// The monotonic wall clock.
class SteadyClock final : public Clock {
 public:
  double now_s() const override;
  void sleep_until(double time_s) override;
};

/// Makes a simulated clock keep pace with wall time: every sleep takes as long as it says.
class PacedClock final : public Clock {
 public:
  explicit PacedClock(Clock& simulated);
  double now_s() const override;
  void sleep_until(double time_s) override;

 private:
  Clock& simulated_;
  SteadyClock wall_;
  double offset_s_;
};

}  // namespace lodestone::common
