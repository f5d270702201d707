#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/guard.h"
#include "lodestone/geometry/keep_out.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"
#include "lodestone/safety/check.h"
#include "lodestone/safety/keep_out_check.h"
#include "lodestone/safety/needle_seen_check.h"
#include "lodestone/safety/operator_stop.h"
#include "lodestone/safety/thermal_model.h"

namespace lodestone::safety {

/// What the coils may be asked for, and what a run must keep to. Every bound has a range of its own, within
/// which it can trip: none can be switched off.
struct SafetyConfig {
  double max_current_A = 20.0;
  double max_pulse_s = 0.25;
  double max_temperature_C = 90.0;
  double max_power_W = 1200.0;
  double max_duty = 0.6;
  double duty_window_s = 10.0;
  double temperature_tolerance_K = 30.0;
  double geofence = 1.4;
  std::vector<geometry::Zone> keep_out;
  std::string keep_out_file;
  double keep_out_margin_m = 0.001;
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
            {0.01, 0.9});
    v.field("duty_window_s", duty_window_s, "s", "over about this time", {0.1, 60.0});
    v.field("temperature_tolerance_K", temperature_tolerance_K, "K",
            "a coil that measures so far from what its pulses explain stops the run", {1.0, 60.0});
    v.field("geofence", geofence, "dish radii",
            "a needle seen further from the dish centre than this stops the run", {0.5, 1.5});
    v.list("keep_out", keep_out, geometry::Zone{},
           "zones that the needle must keep out of: ways are planned around them, and it is scored by them, "
           "too");
    v.field("keep_out_file", keep_out_file, "",
            "file {\"keep_out\": [...]} of more zones, which may move: it is read again at every pose, "
            "before its pulse; empty: no file");
    v.field(
        "keep_out_margin_m", keep_out_margin_m, "m",
        "a needle that may lie nearer to one of them than this stops the run; a pulse that begins outside "
        "this margin can still take it further",
        {0.0, 0.05});
    v.field("max_pose_age_s", max_pose_age_s, "s",
            "a pose older than this, also by the time of its pulse, stops the run", {0.01, 2.0});
    v.field("max_late_s", max_late_s, "s", "a step that begins later than this is a missed deadline",
            {1e-3, 1.0});
    v.field("max_late_steps", max_late_steps, "", "so many missed deadlines in a row stop the run", {1, 10});
    v.field("stop_file", stop_file, "", "the run stops as soon as this file exists; empty: no file");
    v.retired("thermal", "rig.coils and rig.ambient_C");
    v.retired("geofence_m", "geofence, in dish radii");
  }

  /// Whether there is anything to keep out of, or may be later.
  bool has_zones() const { return !keep_out.empty() || !keep_out_file.empty(); }
  /// What the needle of this rig must keep out of now. A sphere is as thick as one, and has no length. Throws
  /// ConfigError where the file of zones cannot be read.
  geometry::KeepOut keeps_out(const physics::RigDescription& rig) const;
};

/// Stands in front of every Coils, with a list of checks. It stops all coils for good as soon as one of them
/// does not trust what it sees, a device or the sensor fails, or the operator says stop. The reason is kept
/// and logged, and every pulse after that is refused. One thread drives; stop(), request_stop(), status() and
/// what it tells of itself may be used from any.
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
  /// The same without a pose: at most 2 A, and at most 6 since the last pose.
  void probe(const rig::CoilPulse& pulse) override;
  /// Switches off now; the next pulse may switch on again.
  void stop() noexcept override { coils_.stop(); }
  rig::CoilStatus status() override { return coils_.status(); }

  /// From any thread: the zones that the needle must keep out of, but for those of the file, have moved.
  void move_keep_out(std::vector<geometry::Zone> zones) { keep_out_->move_zones(std::move(zones)); }
  /// From any thread: all of them now; where the file cannot be read, as it was read last.
  std::vector<geometry::Zone> keep_out() const { return keep_out_->zones(); }

  /// Switches off now and for good: whoever drives is told `reason` at its next call.
  void request_stop(const std::string& reason);

  /// Throws HardwareError while something that can be asked without a pulse still says stop: the file, that
  /// of zones that cannot be read, a device, the temperature of a coil. For the thread that drives.
  void check_cause_is_gone();
  /// Takes pulses again after a stop, on the word of an operator who has seen its reason. Throws as
  /// check_cause_is_gone(), and stays stopped then. What it knows of heat and duty is kept. For the thread
  /// that drives.
  void rearm();

  bool latched() const { return latched_; }
  std::string reason() const;
  /// What the coils reported before the last pulse; nothing before the first. For the thread that drives.
  const std::optional<rig::CoilStatus>& reported() const { return reported_; }
  /// Pulses that were cut to a limit.
  std::int64_t limited() const { return limited_; }

 private:
  [[noreturn]] void latch(const std::string& reason);
  void refuse_if_stopped();
  PulseContext context();
  void give(const rig::CoilPulse& pulse, bool probe);
  template <class Action>
  void guarded(const Action& action);

  rig::Coils& coils_;
  const common::Clock& clock_;
  OperatorStop operator_;
  ThermalModel thermal_;
  NeedleSeenCheck needle_seen_;
  std::vector<std::unique_ptr<StepCheck>> step_checks_;
  std::vector<std::unique_ptr<PoseCheck>> pose_checks_;
  std::vector<std::unique_ptr<PulseCheck>> pulse_checks_;
  KeepOutCheck* keep_out_ = nullptr;  // one of pose_checks_
  bool needle_required_;
  std::optional<rig::CoilStatus> reported_;
  rig::CoilPulse last_;
  double last_s_ = 0.0;
  std::atomic<std::int64_t> limited_{0};
  std::atomic<bool> latched_{false};
  mutable std::mutex mutex_;  // of the texts
  std::string reason_;
  std::string requested_;
};

}  // namespace lodestone::safety
