#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/guard.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/control/recovery.h"
#include "lodestone/control/reference.h"
#include "lodestone/control/rig_identifier.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/coils.h"
#include "lodestone/task/action.h"

namespace lodestone::control {

/// Section IV-B3: a pulse of 100 ms, a rest of 200 ms, about 3 Hz.
struct ControlLoopConfig {
  double pulse_s = 0.1;
  double rest_s = 0.2;
  double decide_s = 0.0;
  std::int64_t max_invalid_poses = 20;
  RecoveryConfig recovery;

  double period_s() const { return pulse_s + rest_s; }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("pulse_s", pulse_s, "s", "length of a current pulse", {0.001, 10.0});
    v.field("rest_s", rest_s, "s", "rest after it, until the needle lies still", {0.0, 10.0});
    v.field("decide_s", decide_s, "s",
            "time for looking and deciding: pulses begin so long after their step began, however fast that "
            "was; 0: "
            "as soon as possible",
            {0.0, 1.0});
    v.field("max_invalid_poses", max_invalid_poses, "",
            "observations in a row without a pose that stop the run", {1, 100000});
    v.group("recovery", recovery, "what is tried when the needle is not seen");
  }
};

/// One step: what was seen, what was wanted and what was done.
struct StepRecord {
  double time_s = 0.0;  ///< since the start of the run
  PoseEstimate estimate;
  geometry::Vector2 target_m = geometry::Vector2::Zero();
  std::optional<double> target_heading_rad;            ///< where the task wants one
  geometry::Drive action = geometry::Drive::Zero(2);   ///< as given, clipped to [-1, 1]
  geometry::Drive drive_A = geometry::Drive::Zero(2);  ///< in A of the rig's drive (physics::CoilDrive),
  physics::PerCoil current_A;                          ///< and what that asks of the coils
  bool either_way =
      false;  ///< head and tail were not told apart, and the controller asked for this whichever is which
  bool probe = false;                         ///< the needle was not seen, and this looked for it
  std::optional<task::DriveGain> drive_gain;  ///< as identified from the pulses before
  bool rig_changed = false;                   ///< what they do is no longer explained by it
  bool last = false;                          ///< the closing observation: no pulse followed
};

struct LoopOutcome {
  std::vector<StepRecord> steps;  ///< one per pulse, and one closing observation
  bool completed = false;         ///< the reference was followed to its end
  std::string stop_reason;        ///< why the run ended early; empty when completed
};

/// Runs one controller on one rig. Observe, decide, check, pulse, rest, until the reference is finished.
class ControlLoop {
 public:
  /// Called at every observation, before the pulse: scoring looks at the true pose here.
  using Observer = std::function<void(const StepRecord&)>;

  /// Everything must outlive the loop. `action` must map to amperes. Without a `rig` the coils are the
  /// paper's four, unless drive_with() says otherwise, and a needle that is not seen is waited for; with one
  /// it is looked for, too (Recovery). With an `identifier`, which is not reset but for a flow, the
  /// controller is told what the pulses say about the rig. Throws ConfigError where an action of 1 would mean
  /// no current.
  ControlLoop(const ControlLoopConfig& config, const task::ActionConfig& action, Guard& coils,
              PoseSensor& sensor, common::Clock& clock, const physics::RigDescription* rig = nullptr,
              RigIdentifier* identifier = nullptr);

  /// Never throws for what sensor, controller or coils do: any fault stops the coils and is the outcome's
  /// stop_reason, and so is the user's interrupt. Without a valid pose the controller is not asked, but where
  /// only head and tail are not told apart (act_either_way). In real time the calling thread goes before
  /// others until it returns (common::RealtimeThread).
  LoopOutcome run(Controller& controller, Reference& reference, const Observer& observer = {});

  double period_s() const { return config_.period_s(); }
  /// What actions mean for the coils of a rig whose needle is not to be looked for.
  void drive_with(physics::CoilDrive drive) { drive_ = std::move(drive); }
  /// Runs that may go on for days: the outcome has no steps, only the observer sees them.
  void forget_steps() { keeps_steps_ = false; }

  /// From any thread: switches the coils off now and ends the run, or the next one where none is under way.
  /// The reason is the outcome's stop_reason.
  void interrupt(const std::string& reason);

 private:
  void rest_until(double time_s);
  void pulse(const StepRecord& record);
  /// `at_m`: where the needle is, or was when it was last seen.
  void drive(StepRecord& record, const geometry::Drive& drive_A, const geometry::Vector2& at_m) const;
  void look_for_it(StepRecord& record, const geometry::Vector2& at_m);
  [[noreturn]] void throw_interrupted();
  void follow(Controller& controller, Reference& reference, const Observer& observer, LoopOutcome& outcome);

  ControlLoopConfig config_;
  task::ActionConfig action_;
  Guard& coils_;
  PoseSensor& sensor_;
  common::Clock& clock_;
  physics::CoilDrive drive_;
  std::optional<Recovery> recovery_;
  RigIdentifier* identifier_;
  bool keeps_steps_ = true;
  double pulse_over_s_ = 0.0;  // when the last one is, on the clock
  common::Interruption interruption_;
  std::mutex mutex_;  // of the reason
  std::string interrupted_by_;
};

}  // namespace lodestone::control
