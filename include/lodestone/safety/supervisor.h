#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "lodestone/common/clock.h"
#include "lodestone/control/guard.h"
#include "lodestone/rig/coils.h"
#include "lodestone/safety/operator_stop.h"
#include "lodestone/safety/thermal_model.h"

namespace lodestone::safety {

/// What the coils may be asked for, and what a run must keep to. Every bound has a range of its own; none can
/// be switched off.
struct SafetyConfig {
  double max_current_A = 20.0;
  double max_pulse_s = 0.25;
  double max_temperature_C = 90.0;
  double max_power_W = 1200.0;
  double max_duty = 0.6;
  double duty_window_s = 10.0;
  double temperature_tolerance_K = 30.0;
  double geofence = 1.4;
  double max_pose_age_s = 0.5;
  double max_late_s = 0.1;
  std::int64_t max_late_steps = 3;
  std::string stop_file;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_current_A", max_current_A, "A", "currents are limited to this, and to what the rig takes",
            {0.0, 20.0});
    v.field("max_pulse_s", max_pulse_s, "s", "pulses are limited to this", {0.0, 10.0});
    v.field("max_temperature_C", max_temperature_C, "C", "a coil above this stops the run", {0.0, 155.0});
    v.field("max_power_W", max_power_W, "W", "currents are scaled down to this power of all coils together",
            {1.0, 5000.0});
    v.field("max_duty", max_duty, "", "fraction of time that a coil may be on; more stops the run",
            {0.01, 1.0});
    v.field("duty_window_s", duty_window_s, "s", "over about this time", {0.1, 60.0});
    v.field("temperature_tolerance_K", temperature_tolerance_K, "K",
            "a coil that measures so far from what its pulses explain stops the run", {1.0, 60.0});
    v.field("geofence", geofence, "dish radii",
            "a needle seen further from the dish centre than this stops the run", {0.5, 5.0});
    v.field("max_pose_age_s", max_pose_age_s, "s", "a pose older than this stops the run", {0.01, 2.0});
    v.field("max_late_s", max_late_s, "s", "a step that begins later than this is a missed deadline",
            {1e-3, 1.0});
    v.field("max_late_steps", max_late_steps, "", "so many missed deadlines in a row stop the run", {1, 10});
    v.field("stop_file", stop_file, "", "the run stops as soon as this file exists; empty: no file");
    v.retired("thermal", "rig.coils and rig.ambient_C");
    v.retired("geofence_m", "geofence, in dish radii");
  }
};

/// Stands in front of every Coils. It limits current, power and pulse length, and it stops all coils for good
/// on anything it does not trust: numbers that are none, opposite coils driven together, faults and
/// temperatures of the device, temperatures that the pulses do not explain, too much time switched on; a pose
/// that is missing, old, repeated or outside the fence; missed deadlines; the operator. The reason is kept
/// and logged, and every pulse after that is refused.
class Supervisor final : public rig::Coils, public control::Guard {
 public:
  /// Whether pulses need a pose: they do, except where a bench is measured without a needle.
  enum class Poses { kRequired, kNone };

  /// All must outlive the supervisor. `keys`: any key in the terminal stops, too.
  Supervisor(rig::Coils& coils, const SafetyConfig& config, const physics::RigDescription& rig,
             const common::Clock& clock, Poses poses = Poses::kRequired, bool keys = false);

  /// Throws HardwareError with the reason for a stop.
  void begin_step(double due_s) override;
  void observe(const control::PoseEstimate& estimate) override;
  /// Throws HardwareError with the reason when the pulse is refused.
  void apply(const rig::CoilPulse& pulse) override;
  void stop() noexcept override { coils_.stop(); }
  rig::CoilStatus status() override { return coils_.status(); }

  bool latched() const { return !reason_.empty(); }
  const std::string& reason() const { return reason_; }
  /// Pulses that were cut to a limit.
  std::int64_t limited() const { return limited_; }

 private:
  [[noreturn]] void latch(const std::string& reason);
  void refuse_if_latched() const;
  void check_operator();
  rig::CoilPulse within_limits(const rig::CoilPulse& pulse);
  void check_status();
  void check_duty(const rig::CoilPulse& pulse);
  void settle_last_pulse(double now_s);

  rig::Coils& coils_;
  SafetyConfig config_;
  double max_current_A_;
  double geofence_m_;
  const common::Clock& clock_;
  Poses poses_;
  OperatorStop operator_;
  ThermalModel thermal_;
  std::string reason_;
  std::int64_t limited_ = 0;
  std::int64_t late_steps_ = 0;
  bool has_pose_ = false;  // since the last pulse
  bool had_pose_ = false;  // ever
  double pose_stamp_s_ = 0.0;
  double seen_s_ = 0.0;  // when that pose was handed in
  rig::CoilPulse last_;
  double last_s_ = 0.0;
  std::array<bool, rig::kCoilCount> temperature_known_{};
  std::array<double, rig::kCoilCount> on_level_s_{};  // leaky count of time switched on
};

}  // namespace lodestone::safety
