#pragma once

#include <string>
#include <vector>

#include "lodestone/vision/rod_fit.h"

namespace lodestone::vision {

/// What one look shows: the needle; several things that look like it; or nothing, and why.
struct Sighting {
  double stamp_s = 0.0;         ///< on the rig's clock
  std::vector<Rod> candidates;  ///< axes that are seen; poses point to the end that the tape speaks for
  std::string reason;           ///< why there is no candidate
};

}  // namespace lodestone::vision
