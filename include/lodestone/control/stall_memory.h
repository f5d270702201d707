#pragma once

#include <vector>

#include "lodestone/control/motion_model.h"

namespace lodestone::control {

/// Friction stays with the place: a pulse like one that moved nothing where the needle lies moves nothing
/// again, and says nothing new.
class StallMemory {
 public:
  /// Two drives are alike that differ by less than this part of the stronger.
  static constexpr double kAlikeDrive = 0.25;

  /// A needle that came less far than this has not moved.
  StallMemory(double still_m, double still_rad) : still_m_(still_m), still_rad_(still_rad) {}

  void reset() { stalled_A_.clear(); }
  /// Takes a pulse in; true where it moved nothing, and one like it had done so here before.
  bool repeats(const SeenPulse& pulse);
  /// Whether one like this has moved nothing from here.
  bool stalls(const geometry::Pose2& from, const geometry::Drive& drive_A) const;

 private:
  bool known(const geometry::Drive& drive_A) const;
  bool at_place(const geometry::Pose2& pose) const;

  double still_m_, still_rad_;
  geometry::Pose2 place_;                   // where the needle came to lie
  std::vector<geometry::Drive> stalled_A_;  // drives that moved nothing there
};

}  // namespace lodestone::control
