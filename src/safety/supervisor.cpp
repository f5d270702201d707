#include "lodestone/safety/supervisor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"

namespace lodestone::safety {

namespace {
constexpr const char* kCoilNames[rig::kCoilCount] = {"+x", "-x", "+y", "-y"};
// A shorter or weaker pulse tells too little of a coil's resistance, and so of its temperature.
constexpr double kMinEstimationPulse_s = 0.09;
constexpr double kMinEstimationCurrent_A = 1.0;

template <class... Parts>
std::string line(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}
}  // namespace

Supervisor::Supervisor(rig::Coils& coils, const SafetyConfig& config, const physics::RigDescription& rig,
                       const common::Clock& clock, Poses poses, bool keys)
    : coils_(coils),
      config_(config),
      max_current_A_(std::min(config.max_current_A, rig.coils.max_current_A)),
      geofence_m_(config.geofence * rig.dish.radius_m),
      clock_(clock),
      poses_(poses),
      operator_(config.stop_file, keys),
      thermal_(rig),
      last_s_(clock.now_s()) {}

void Supervisor::latch(const std::string& reason) {
  coils_.stop();
  reason_ = reason;
  common::log_warning("safety stop: " + reason_);
  throw common::HardwareError("safety: " + reason_ + "; the coils are off, find the cause and start again");
}

void Supervisor::refuse_if_latched() const {
  if (latched())
    throw common::HardwareError("safety: stopped earlier (" + reason_ + "); no pulse until a restart");
}

void Supervisor::check_operator() {
  const std::string asked = operator_.asked();
  if (!asked.empty()) latch(asked);
}

void Supervisor::begin_step(double due_s) {
  refuse_if_latched();
  check_operator();
  const double late_s = clock_.now_s() - due_s;
  late_steps_ = late_s > config_.max_late_s ? late_steps_ + 1 : 0;
  if (late_steps_ >= config_.max_late_steps)
    latch(line(late_steps_, " steps in a row began late, the last by ", late_s, " s, limit is ",
               config_.max_late_s, " s: is the machine too slow or too busy?"));
}

void Supervisor::observe(const control::PoseEstimate& estimate) {
  refuse_if_latched();
  has_pose_ = false;
  if (!estimate.valid) return;
  const double now_s = clock_.now_s();
  const double age_s = now_s - estimate.stamp_s;
  if (!(std::abs(age_s) <= config_.max_pose_age_s))
    latch(line("the pose is ", age_s, " s old, limit is ", config_.max_pose_age_s,
               " s: has the camera stalled, or was a clock set?"));
  if (had_pose_ && now_s > seen_s_ && !(estimate.stamp_s > pose_stamp_s_))
    latch("the sensor gave the same pose, or an older one, again: has the camera stalled?");
  const double distance_m = estimate.pose.position_m().norm();
  if (!(distance_m <= geofence_m_))
    latch(line("the needle is seen ", 1e3 * distance_m, " mm from the dish centre, beyond the fence at ",
               1e3 * geofence_m_, " mm (safety.geofence)"));
  has_pose_ = true;
  had_pose_ = true;
  pose_stamp_s_ = estimate.stamp_s;
  seen_s_ = now_s;
}

/// Brings the thermal model and the counts of time switched on up to now.
void Supervisor::settle_last_pulse(double now_s) {
  const double passed_s = std::max(0.0, now_s - last_s_);
  const double on_s = std::min(last_.duration_s, passed_s);
  thermal_.advance(last_.current_A, on_s, passed_s);
  for (std::size_t i = 0; i < on_level_s_.size(); ++i) {
    if (last_.current_A[i] != 0.0) on_level_s_[i] += on_s;
    on_level_s_[i] = std::max(0.0, on_level_s_[i] - config_.max_duty * passed_s);
  }
  last_s_ = now_s;
}

rig::CoilPulse Supervisor::within_limits(const rig::CoilPulse& pulse) {
  if (!std::isfinite(pulse.duration_s) || pulse.duration_s < 0.0)
    latch(line("pulse length is ", pulse.duration_s, " s, must be 0 or more"));
  rig::CoilPulse safe = pulse;
  bool limited = false;
  double power_W = 0.0;
  for (std::size_t coil = 0; coil < safe.current_A.size(); ++coil) {
    double& current_A = safe.current_A[coil];
    if (!std::isfinite(current_A))
      latch(line("current of coil ", kCoilNames[coil], " is ", current_A, " A, must be a finite number"));
    if (std::abs(current_A) > max_current_A_) {
      current_A = std::clamp(current_A, -max_current_A_, max_current_A_);
      limited = true;
    }
    power_W += thermal_.power_W(static_cast<int>(coil), current_A);
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (safe.current_A[2 * axis] != 0.0 && safe.current_A[2 * axis + 1] != 0.0)
      latch(line("opposite coils ", kCoilNames[2 * axis], " and ", kCoilNames[2 * axis + 1],
                 " driven together (", safe.current_A[2 * axis], " A and ", safe.current_A[2 * axis + 1],
                 " A)"));
  if (power_W > config_.max_power_W) {
    for (double& current_A : safe.current_A) current_A *= std::sqrt(config_.max_power_W / power_W);
    limited = true;
  }
  if (safe.duration_s > config_.max_pulse_s) {
    safe.duration_s = config_.max_pulse_s;
    limited = true;
  }
  limited_ += limited ? 1 : 0;
  return safe;
}

void Supervisor::check_status() {
  const rig::CoilStatus status = coils_.status();
  if (!status.faults.empty()) latch("the coils report: " + status.faults.front());
  for (std::size_t coil = 0; coil < status.temperature_C.size(); ++coil) {
    const double measured_C = status.temperature_C[coil];
    // Written so that a temperature that is not a number stops the run, too.
    if (!(measured_C <= config_.max_temperature_C))
      latch(line("coil ", kCoilNames[coil], " is at ", measured_C, " C, limit is ", config_.max_temperature_C,
                 " C"));
    if (std::abs(last_.current_A[coil]) < kMinEstimationCurrent_A || last_.duration_s < kMinEstimationPulse_s)
      continue;
    const double expected_C = thermal_.temperature_C(static_cast<int>(coil));
    if (!temperature_known_[coil]) {  // nobody knows what the coil did before the run
      temperature_known_[coil] = true;
      thermal_.set_temperature_C(static_cast<int>(coil), measured_C);
    } else if (std::abs(measured_C - expected_C) > config_.temperature_tolerance_K) {
      latch(line(
          "coil ", kCoilNames[coil], " measures ", measured_C, " C where its pulses explain ", expected_C,
          " C: check its wires and the supply, or measure the coils again (lodestone calibrate coils)"));
    }
  }
}

void Supervisor::check_duty(const rig::CoilPulse& pulse) {
  for (std::size_t coil = 0; coil < on_level_s_.size(); ++coil) {
    if (pulse.current_A[coil] == 0.0) continue;
    if (on_level_s_[coil] + (1.0 - config_.max_duty) * pulse.duration_s >
        config_.max_duty * config_.duty_window_s)
      latch(line("coil ", kCoilNames[coil], " would be on for more than ", 100.0 * config_.max_duty,
                 " % of the time over ", config_.duty_window_s, " s"));
    const double hot_C =
        thermal_.after_pulse_C(static_cast<int>(coil), pulse.current_A[coil], pulse.duration_s);
    if (!(hot_C <= config_.max_temperature_C))
      latch(line("this pulse would heat coil ", kCoilNames[coil], " to ", hot_C, " C, limit is ",
                 config_.max_temperature_C, " C"));
  }
}

void Supervisor::apply(const rig::CoilPulse& pulse) {
  refuse_if_latched();
  check_operator();
  if (poses_ == Poses::kRequired && !has_pose_)
    latch("a pulse was asked for, but nobody has seen the needle since the last");
  const double now_s = clock_.now_s();
  settle_last_pulse(now_s);
  const rig::CoilPulse safe = within_limits(pulse);
  check_status();
  check_duty(safe);
  has_pose_ = false;
  last_ = safe;
  last_s_ = clock_.now_s();
  try {
    coils_.apply(safe);
  } catch (const std::exception& error) {
    latch(error.what());
  }
}

}  // namespace lodestone::safety
