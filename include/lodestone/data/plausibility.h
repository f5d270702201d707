#pragma once

#include <string>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/data/mapped_log.h"

namespace lodestone::data {

/// What a person gets wrong about a log shows in its numbers. Each throws DataError that begins with `place`
/// and says what to correct.

/// Units and centre: positions that mostly lie outside the dish, or all in a hundredth of it; headings of
/// many turns, or all within a few degrees; currents that never reach a twentieth of the largest.
void check_sizes(const MappedLog& log, double dish_radius_m, const std::string& place);

/// How well recorded motion goes with the drives: motion . drive over the product of their norms, as the
/// columns are understood, and as the best of the eight ways to turn and mirror the axes of the motion.
struct DirectionMatch {
  double as_is = 0.0;
  double best = 0.0;
  std::string best_way;  ///< what the best way says is wrong; empty where nothing is
  std::int64_t driven = 0;
};
DirectionMatch match_directions(const Dataset& dataset);

/// Throws where enough driven steps agree with another way much better: coils pull towards themselves.
void check_directions(const Dataset& dataset, const std::string& place);

}  // namespace lodestone::data
