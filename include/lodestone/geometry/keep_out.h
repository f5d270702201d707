#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/geometry/zone.h"

namespace lodestone::geometry {

/// What a needle must keep out of, and what it is: a segment, seen from above, as thick as its diameter. All
/// who keep it out (plans, the supervisor, scores) measure by this.
struct KeepOut {
  std::vector<Zone> zones;
  double needle_length_m = 0.0;
  double needle_diameter_m = 0.0;
  double margin_m = 0.0;  ///< it must stay further away than this

  bool empty() const { return zones.empty(); }
  /// Of the needle as it lies from a zone; 0 or less where it touches it.
  double clearance_m(const Pose2& pose, const Zone& zone) const;
  /// Of the needle as it lies from the nearest zone; infinite without any.
  double clearance_m(const Pose2& pose) const;
  /// Of the needle's middle from the nearest zone, as it goes straight from one place to another: how near
  /// its sides come, not its ends.
  double clearance_m(const Vector2& from_m, const Vector2& to_m) const;
  /// A middle that has more clearance than this keeps the margin whichever way the needle lies.
  double any_way_m() const { return margin_m + 0.5 * needle_length_m; }
};

}  // namespace lodestone::geometry
