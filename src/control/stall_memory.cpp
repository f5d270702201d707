#include "lodestone/control/stall_memory.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::control {
bool StallMemory::repeats(const SeenPulse& pulse) {
  if (pulse.drive_A.isZero(0.0)) return false;
  if (!at_place(pulse.before)) {
    place_ = pulse.before;
    stalled_A_.clear();
  }
  if (!at_place(pulse.after)) return false;
  const bool again = known(pulse.drive_A);
  if (!again) stalled_A_.push_back(pulse.drive_A);
  return again;
}

bool StallMemory::stalls(const geometry::Pose2& from, const geometry::Drive& drive_A) const {
  return at_place(from) && known(drive_A);
}

bool StallMemory::known(const geometry::Drive& drive_A) const {
  return std::any_of(stalled_A_.begin(), stalled_A_.end(), [&](const geometry::Drive& stalled_A) {
    return (drive_A - stalled_A).norm() < kAlikeDrive * std::max(drive_A.norm(), stalled_A.norm());
  });
}

bool StallMemory::at_place(const geometry::Pose2& pose) const {
  const double turned_rad = geometry::wrap_angle(pose.heading_rad - place_.heading_rad);
  return (pose.position_m() - place_.position_m()).norm() < still_m_ && std::abs(turned_rad) < still_rad_;
}

}  // namespace lodestone::control
