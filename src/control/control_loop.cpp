#include "lodestone/control/control_loop.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/realtime.h"
#include "lodestone/control/either_way.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {

namespace {

/// So much of a period may be caught up where a pulse came late. More would take the rest from it, and what
/// is seen next would be a needle that still moves.
constexpr double kCaughtUp = 1.0 / 3.0;

bool finite(const geometry::Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.heading_rad);
}

/// Sensed poses and what was done between them.
struct Memory {
  bool has_pose = false;
  geometry::Pose2 pose;
  geometry::Drive action;
  std::optional<geometry::Pose2> pose_before;  // the last pulse, which was not a probe
  double began_s = 0.0;                        // the step of that pulse

  task::Observation observe(const geometry::Pose2& now, const geometry::Vector2& target_m,
                            std::optional<double> target_heading_rad) const {
    task::Observation observation;
    observation.pose = now;
    observation.target_m = target_m;
    observation.target_heading_rad = target_heading_rad;
    observation.last_action = action;
    if (has_pose) observation.last_displacement_m = now.position_m() - pose.position_m();
    return observation;
  }
};

/// A sensor that fails is a fault of the rig, and told like any other.
PoseEstimate sensed(PoseSensor& sensor) {
  try {
    return sensor.observe();
  } catch (const common::HardwareError& error) {
    PoseEstimate none;
    none.fault = true;
    none.reason = error.what();
    return none;
  }
}

geometry::Drive checked(const geometry::Drive& action, int size) {
  LODESTONE_CHECK(action.size() == size, "an action of " + std::to_string(size) + " numbers, not of " +
                                             std::to_string(action.size()));
  if (!action.allFinite())
    throw common::HardwareError("the controller asked for a drive that is not a number");
  return geometry::saturated(action);
}

}  // namespace

ControlLoop::ControlLoop(const ControlLoopConfig& config, const task::ActionConfig& action, Guard& coils,
                         PoseSensor& sensor, common::Clock& clock, const physics::RigDescription* rig,
                         RigIdentifier* identifier)
    : config_(config),
      action_(action),
      coils_(coils),
      sensor_(sensor),
      clock_(clock),
      identifier_(identifier) {
  if (!(action.scale > 0.0))
    throw common::ConfigError(
        "an action of 1 would mean no current: the largest one (rig.coils.max_current_A) must be above 0");
  if (rig == nullptr) return;
  recovery_.emplace(config.recovery, *rig);
  drive_ = physics::CoilDrive(*rig);
}

LoopOutcome ControlLoop::run(Controller& controller, Reference& reference, const Observer& observer) {
  LoopOutcome outcome;
  std::optional<common::RealtimeThread> realtime;
  if (clock_.passes_by_itself()) realtime.emplace();
  try {
    follow(controller, reference, observer, outcome);
  } catch (const std::exception& error) {
    outcome.stop_reason = error.what();
  } catch (...) {
    outcome.stop_reason = "unknown fault";
  }
  coils_.stop();
  if (clock_.now_s() < pulse_over_s_) sensor_.pulse_cut();
  interruption_.clear();
  outcome.completed = outcome.stop_reason.empty();
  return outcome;
}

void ControlLoop::interrupt(const std::string& reason) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    interrupted_by_ = reason;
  }
  interruption_.raise();
  coils_.stop();
}

void ControlLoop::throw_interrupted() {
  const std::lock_guard<std::mutex> lock(mutex_);
  throw common::HardwareError(interrupted_by_);
}

void ControlLoop::rest_until(double time_s) {
  if (!clock_.wait_until(time_s, &interruption_)) throw_interrupted();
}

void ControlLoop::pulse(const StepRecord& record) {
  const double begins_s = clock_.now_s();
  if (record.probe)
    coils_.probe({record.current_A, config_.pulse_s});
  else if (record.estimate.valid || record.either_way)
    coils_.apply({record.current_A, config_.pulse_s});
  else
    return;
  pulse_over_s_ = begins_s + config_.pulse_s;
  const bool expected = identifier_ != nullptr && record.estimate.valid;
  sensor_.pulsed(record.current_A, expected ? identifier_->outcomes(record.estimate.pose,
                                                                    task::drive_of(record.action, action_))
                                            : std::vector<physics::PulseOutcome>{});
}

void ControlLoop::drive(StepRecord& record, const geometry::Drive& drive_A,
                        const geometry::Vector2& at_m) const {
  record.drive_A = drive_A;
  record.current_A = drive_.current_A(drive_A, at_m);
}

void ControlLoop::look_for_it(StepRecord& record, const geometry::Vector2& at_m) {
  const std::optional<geometry::Drive> probe_A = recovery_ ? recovery_->next_probe() : std::nullopt;
  record.probe = probe_A.has_value();
  if (!probe_A) return;
  // A probe says how much any coil may get: a drive along both axes may ask more of one that serves both.
  drive(record, *probe_A, at_m);
  const double allowed_A = probe_A->cwiseAbs().maxCoeff();
  double most_A = 0.0;
  for (const double current_A : record.current_A) most_A = std::max(most_A, std::abs(current_A));
  if (most_A > allowed_A) drive(record, *probe_A * ((1.0 - 1e-9) * allowed_A / most_A), at_m);
}

void ControlLoop::follow(Controller& controller, Reference& reference, const Observer& observer,
                         LoopOutcome& outcome) {
  controller.reset();
  reference.reset();
  pulse_over_s_ = clock_.now_s();
  if (recovery_) recovery_->reset();
  if (identifier_ != nullptr) identifier_->begin_run();
  const geometry::Drive none = geometry::Drive::Zero(drive_.size());
  Memory memory;
  memory.action = none;
  std::int64_t invalid_in_a_row = 0;
  try {
    sensor_.acquire();
  } catch (const common::HardwareError&) {
    // The first observation says so, too.
  }
  double start_s = clock_.now_s();
  double set_back_s = 0.0;  // the schedule, after the last pulse
  double next_pulse_s = start_s + config_.decide_s;
  for (std::int64_t step = 0;; ++step) {
    // Counted from the start, so that rounding does not add up.
    const double due_s = static_cast<double>(step) * config_.period_s();
    if (interruption_.raised()) throw_interrupted();
    coils_.begin_step(start_s + due_s - set_back_s);
    StepRecord record;
    record.time_s = due_s;
    record.action = record.drive_A = none;
    record.current_A.assign(drive_.coils(), 0.0);
    record.estimate = sensed(sensor_);
    record.estimate.valid = record.estimate.valid && finite(record.estimate.pose);
    record.estimate.either_way = record.estimate.either_way && finite(record.estimate.pose);
    coils_.observe(record.estimate);
    if (record.estimate.fault) throw common::HardwareError(record.estimate.reason);
    const geometry::Pose2 seen = record.estimate.valid ? record.estimate.pose : memory.pose;
    const geometry::Vector2 seen_m = seen.position_m();
    record.target_m = reference.target(due_s, seen);
    record.target_heading_rad = reference.target_heading_rad();
    record.last = reference.finished(due_s);
    const auto observed = [&] {
      task::Observation observation =
          memory.observe(record.estimate.pose, record.target_m, record.target_heading_rad);
      if (identifier_ != nullptr) {
        observation.drive_gain = identifier_->gain();
        observation.drift_m = identifier_->drifts_m(due_s, config_.period_s(), kStepsAhead);
      }
      observation.awaited = reference.awaits();
      observation.ahead = reference.ahead(due_s, config_.period_s(), kStepsAhead);
      return observation;
    };
    if (record.estimate.valid) {
      invalid_in_a_row = 0;
      if (identifier_ != nullptr) {
        if (memory.pose_before)
          identifier_->learn({*memory.pose_before, task::drive_of(memory.action, action_),
                              record.estimate.pose, memory.began_s});
        record.drive_gain = identifier_->gain();
        record.rig_changed = identifier_->changed();
      }
      if (!record.last) {
        record.action = checked(controller.act(observed()), drive_.size());
        drive(record, task::drive_of(record.action, action_), seen_m);
      }
      if (recovery_) recovery_->seen(record.estimate.pose);
      memory.has_pose = true;
      memory.pose_before = record.estimate.pose;
      memory.pose = seen;
    } else {
      ++invalid_in_a_row;
      memory.pose_before.reset();
      const std::optional<geometry::Drive> agreed = record.estimate.either_way && !record.last
                                                        ? act_either_way(controller, observed(), action_)
                                                        : std::nullopt;
      record.either_way = agreed.has_value();
      if (agreed) {
        record.action = checked(*agreed, drive_.size());
        drive(record, task::drive_of(record.action, action_), record.estimate.pose.position_m());
      } else if (!record.last && !record.estimate.blind) {
        look_for_it(record, seen_m);
      }
      if (record.estimate.reason.empty())
        record.estimate.reason = "the sensor gave a pose that is not a number";
    }
    memory.action = record.estimate.valid ? record.action : none;
    memory.began_s = due_s;
    if (keeps_steps_) outcome.steps.push_back(record);
    if (observer) observer(record);
    if (record.last) return;
    if (invalid_in_a_row >= config_.max_invalid_poses)
      throw common::HardwareError("no pose for " + std::to_string(invalid_in_a_row) +
                                  " observations in a row: " + record.estimate.reason);
    // A camera that runs freely gives its image sooner or later; the pulses still come evenly.
    if (config_.decide_s > 0.0) rest_until(start_s + due_s + config_.decide_s);
    if (interruption_.raised()) throw_interrupted();
    const double late_s = clock_.now_s() - next_pulse_s;
    set_back_s = late_s > kCaughtUp * config_.period_s() ? late_s : 0.0;
    start_s += set_back_s;
    next_pulse_s += late_s + config_.period_s();
    pulse(record);
    if (identifier_ != nullptr) {  // while the pulse is on
      identifier_->check();
      if (memory.pose_before)
        identifier_->expect(*memory.pose_before, task::drive_of(record.action, action_));
    }
    rest_until(start_s + static_cast<double>(step + 1) * config_.period_s());
  }
}

}  // namespace lodestone::control
