#pragma once

#include "lodestone/common/error.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/rig/coils.h"

namespace lodestone::safety {

/// A check does not trust what it sees: the reason for which the supervisor stops the coils for good.
class Distrust final : public common::HardwareError {
 public:
  using HardwareError::HardwareError;
};

/// Looks at the beginning of every step of the control loop.
class StepCheck {
 public:
  virtual ~StepCheck() = default;
  /// Throws Distrust.
  virtual void begin_step(double now_s, double due_s) = 0;
};

/// Looks at every pose that is valid.
class PoseCheck {
 public:
  virtual ~PoseCheck() = default;
  /// Throws Distrust.
  virtual void observe(const control::PoseEstimate& estimate, double now_s) = 0;
};

/// What is known when a pulse is asked for.
struct PulseContext {
  rig::CoilPulse last;    ///< the pulse before
  double on_s = 0.0;      ///< how long it has been on, and
  double passed_s = 0.0;  ///< how long ago it began
  double now_s = 0.0;
  rig::CoilStatus status;
};

/// Looks at every pulse, and may cut it to a limit.
class PulseCheck {
 public:
  virtual ~PulseCheck() = default;
  /// Throws Distrust.
  virtual void check(rig::CoilPulse& pulse, const PulseContext& context) = 0;
};

}  // namespace lodestone::safety
