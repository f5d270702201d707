#pragma once

#include "lodestone/common/random.h"

namespace lodestone::common {

/// A factor that is drawn uniformly between two bounds; `"key": [low, high]` in a configuration.
struct Range {
  double low;
  double high;

  double draw(RandomStream& random) const { return random.uniform(low, high); }
};

}  // namespace lodestone::common
