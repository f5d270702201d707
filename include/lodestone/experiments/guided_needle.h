#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "lodestone/control/control_loop.h"
#include "lodestone/control/decorators.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/experiments/qualification_statistics.h"
#include "lodestone/experiments/refusal_map.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/session/rig_session.h"

namespace lodestone::experiments {

/// How a needle is brought to places where something is measured.
struct GuidedNeedleConfig {
  double look_s = 1.0 / 30.0;
  control::ControlLoopConfig loop;
  control::DipolePullConfig baseline;
  control::DecoratorConfig decorators;

  /// The pull, made stronger and turned where the needle sticks: nobody places it.
  GuidedNeedleConfig() {
    decorators.stall_gain = 1.5;
    decorators.direction_dither_deg = 30.0;
  }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("look_s", look_s, "s", "least time from look to look, where a camera gives images faster",
            {1e-3, 1.0});
    v.group("loop", loop, "timing of the control loop, and of single pulses");
    v.group("baseline", baseline, "the pull that brings the needle to places");
    v.group("decorators", decorators, "what is put around it");
  }
};

/// The needle of a session as somebody who measures has it: looked at, pulsed, brought to places. Everything
/// goes through the session's supervisor; looks are counted (RefusalMap). What throws HardwareError below
/// does so where the supervisor stops, on a key or a signal, too.
class GuidedNeedle {
 public:
  /// All must outlive it.
  GuidedNeedle(const GuidedNeedleConfig& config, const rig::RigConfig& rig, session::RigSession& session);

  /// Owes nothing to what was before, as after a restart of the program: what the sensor believes and where
  /// the needle lay is forgotten, and the sensor takes its time to find it. Throws HardwareError.
  void begin();
  /// The next look. Throws HardwareError.
  control::PoseEstimate look();
  /// A look at a needle on whose pulse nothing has been seen yet: `pulse` is on, or was just now.
  control::PoseEstimate look_during(const rig::CoilPulse& pulse);
  /// One that owes nothing to those before: what the sensor believes is forgotten. It is not counted.
  control::PoseEstimate fresh_look();
  /// Where it lies, as seen since the last pulse; nothing where ten looks give no pose. Throws HardwareError.
  std::optional<geometry::Pose2> here();

  /// Gives a pulse to a needle that here() has seen, and returns while it is on. Throws HardwareError.
  void pulse(const rig::CoilPulse& pulse);
  /// Waits until pulse and rest are over.
  void rest();
  /// A pulse of the loop's length, its rest, and what it did; nothing where the needle was not seen before or
  /// after it. Throws HardwareError.
  std::optional<PulseMotion> push(const geometry::Drive& drive_A);
  /// The same of two numbers, as physics::CoilDrive::along.
  std::optional<PulseMotion> push_along(const geometry::Vector2& direction_A);

  /// Drives it there, in at most 15 s. Returns whether it came so near. Throws HardwareError where the run
  /// was stopped: no pose for long, or the supervisor.
  bool bring_to(const geometry::Vector2& target_m, double within_m);

  /// The coils' part of a drive for a needle at a place.
  rig::CoilPulse pulse_along(const geometry::Vector2& direction_A, const geometry::Vector2& position_m) const;
  const RefusalMap& refusals() const { return refusals_; }
  /// Goes on counting from there. Throws DataError.
  void restore_refusals(const RefusalCounts& counts) { refusals_.restore(counts); }

 private:
  control::PoseEstimate observed();

  GuidedNeedleConfig config_;
  const rig::RigConfig& rig_;
  session::RigSession& session_;
  physics::CoilDrive drive_;
  std::unique_ptr<control::Controller> controller_;
  RefusalMap refusals_;
  std::optional<geometry::Pose2> here_;
  double looked_s_;
  double pulse_ends_s_;
};

}  // namespace lodestone::experiments
