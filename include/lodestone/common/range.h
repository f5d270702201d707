#pragma once

#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

namespace lodestone::common {

/// A factor that is drawn uniformly between two bounds; `"key": [low, high]` in a configuration.
struct Range {
  Range(double low, double high) : bounds{low, high} {}

  double low() const { return bounds.front(); }
  double high() const { return bounds.back(); }
  double middle() const { return 0.5 * (low() + high()); }
  double draw(RandomStream& random) const { return random.uniform(low(), high()); }

  /// Throws ConfigError naming `key` unless it holds two numbers in order.
  void validate(const std::string& key) const {
    if (bounds.size() != 2 || !(bounds[0] <= bounds[1]))
      throw ConfigError(key + " = " + Json(bounds).dump() + ", must be [low, high] with low <= high");
  }

  std::vector<double> bounds;
};

}  // namespace lodestone::common
