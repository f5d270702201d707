#pragma once

#include "lodestone/control/pose_sensor.h"
#include "lodestone/rig/coils.h"

namespace lodestone::control {

/// What stands between the control loop and the coils: hears of every step, sees every pose, lets a pulse
/// through or throws HardwareError with the reason for a stop.
class Guard {
 public:
  virtual ~Guard() = default;
  /// A step begins that was due at `due_s`.
  virtual void begin_step(double due_s) = 0;
  /// What the sensor saw; poses that are not valid are handed in, too. The place of one whose head and tail
  /// were not told apart counts as seen.
  virtual void observe(const PoseEstimate& estimate) = 0;
  virtual void apply(const rig::CoilPulse& pulse) = 0;
  /// A weak pulse for a needle that is not seen, to find it: the only one that needs no pose, and few of
  /// them.
  virtual void probe(const rig::CoilPulse& pulse) = 0;
  virtual void stop() noexcept = 0;
};

}  // namespace lodestone::control
