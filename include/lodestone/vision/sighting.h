#pragma once

#include <string>
#include <vector>

#include "lodestone/vision/rod_fit.h"

namespace lodestone::vision {

/// Whether the camera stands where it was calibrated: it does; it has been seen to have moved; or nothing is
/// seen of what would tell, since something covers it, or the camera has moved far.
enum class CameraPlace { kKept, kMoved, kUnknown };

/// What one look shows: the needle; several things that look like it; or nothing, and why.
struct Sighting {
  double stamp_s = 0.0;         ///< on the rig's clock
  std::vector<Rod> candidates;  ///< axes that are seen; poses point to the end that the tape speaks for
  std::string reason;           ///< why there is no candidate
  CameraPlace camera = CameraPlace::kKept;  ///< where it is not, there is no candidate
};

}  // namespace lodestone::vision
