#pragma once

#include "lodestone/geometry/pose2.h"
#include "lodestone/vision/sighting.h"

namespace lodestone::session {

/// Sees what may be the needle, one image at a time. Implementations: camera; simulated (the true pose plus
/// the localiser's measured error).
class NeedleDetector {
 public:
  virtual ~NeedleDetector() = default;
  /// Throws HardwareError when the camera fails.
  virtual vision::Sighting look() = 0;
  /// The next look begins there, or searches the whole dish.
  virtual void expect(const geometry::Vector2& /*near_m*/) {}
  virtual void search() {}
  /// The needle has been placed elsewhere.
  virtual void reset() = 0;
};

}  // namespace lodestone::session
