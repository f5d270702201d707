#pragma once

#include <string>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/data/mapped_log.h"

namespace lodestone::data {

/// What a person gets wrong about a log shows in its numbers. Each throws DataError that begins with `place`
/// and says what to correct.

/// How far a log's rows reach, and what its file calls its columns.
struct LogSizes {
  std::size_t rows = 0;
  double reach_m = 0.0;            ///< of the position furthest from the centre
  std::size_t outside = 0;         ///< positions outside the dish
  std::int64_t outside_line = 0;   ///< of the first of them
  double most_turned_rad = 0.0;    ///< largest heading as it stands, without regard to full turns
  double most_drive = 0.0;         ///< in `action_unit`
  double largest_drive = 0.0;      ///< what the rig can
  std::string action_unit = "A";   ///< or "percent"
  std::string heading_unit;        ///< "rad" or "deg"; empty where there is no heading
  std::string positions, heading;  ///< of what columns, in messages
  std::string currents;

  void see(const geometry::Vector2& position_m, double dish_radius_m, std::int64_t line);
};
LogSizes sizes_of(const MappedLog& log, double dish_radius_m);

/// Units and centre: positions that mostly lie outside the dish, or all in a hundredth of it; headings of
/// many turns, or all within a few degrees; currents that never reach a twentieth of the largest.
void check_sizes(const LogSizes& sizes, double dish_radius_m, const std::string& place);

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
