#pragma once

#include <string>
#include <utility>

#include "lodestone/physics/coils_description.h"
#include "lodestone/rig/driver_coils.h"

namespace lodestone::rig {

/// Whether the currents that a device says it has measured can be those of what was asked: what the firmware
/// of the coil controller looks after by itself (docs/serial-protocol.md, faults 2 to 4), for devices that
/// nobody has checked. Times are of one clock, in s; what was asked at one time and answered at another
/// happened in between.
class CurrentWatch {
 public:
  explicit CurrentWatch(physics::CoilsDescription coils) : coils_(std::move(coils)) {}

  void pulse(const CoilPulse& pulse, double asked_s, double answered_s);
  void stop(double now_s);
  /// Why the currents cannot be; empty: they can.
  std::string distrust(const physics::PerCoil& measured_A, double asked_s, double answered_s);
  /// Nothing flows any more, and that was seen.
  bool over() const { return over_; }
  /// When currents are next worth a look, after one at `last_s`.
  double look_at_s(double last_s) const;

 private:
  physics::CoilsDescription coils_;
  physics::PerCoil asked_A_;
  physics::PerCoil off_since_s_;  ///< when each coil has been told to be off at the latest
  double steady_from_s_ = 0.0;
  double steady_until_s_ = 0.0;
  bool over_ = true;
};

}  // namespace lodestone::rig
