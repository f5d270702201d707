#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/data/dataset_info.h"

namespace lodestone::data {

/// A position further away is no glitch of a camera but garbage.
constexpr double kFarthestGlitch_m = 1e3;

/// One stretch of pulses without a reset in between. All arrays are row-major; S numbers a state, A an
/// action.
struct Episode {
  std::vector<double> observations;        ///< [T + 1, S]
  std::vector<double> actions;             ///< [T, A] in the dataset's action unit (A, or percent of range)
  std::vector<std::uint8_t> terminations;  ///< [T] 1: the episode ended by itself here
  std::vector<std::uint8_t> truncations;   ///< [T] 1: it was cut here
  std::vector<std::uint8_t> zero_current;  ///< [T] 1: nothing was applied (kept, but not for training)
  /// How often an operator has placed the robot since the episode before; 0: it begins where that one ended.
  std::int64_t placements = 1;

  std::int64_t length() const { return static_cast<std::int64_t>(terminations.size()); }
};

struct Dataset {
  DatasetInfo info;
  std::vector<Episode> episodes;
  /// Recorded steps from or to a position where nothing can be. No part of the data: evaluation says what
  /// they would change.
  std::vector<Episode> impossible;

  std::int64_t transitions() const;
  std::int64_t placements() const;
};

/// The first so many transitions; the last episode is cut to fit. All of them when there are fewer.
Dataset first_transitions(Dataset dataset, std::int64_t count);
/// The first `steps` steps of an episode, truncated there.
Episode first_steps(const Episode& episode, std::int64_t steps);

/// Flat rows of every transition: what training and baselines use.
struct TransitionTable {
  int state_size = 0;
  int action_size = 2;
  std::vector<double> state;          ///< [N, S]
  std::vector<double> action;         ///< [N, A]
  std::vector<double> next_state;     ///< [N, S]
  std::vector<std::int64_t> episode;  ///< [N] index of the episode a row comes from

  std::int64_t size() const { return static_cast<std::int64_t>(episode.size()); }
};

/// The largest of the numbers of an action, whatever their signs.
double strongest(const double* action, int action_size);

/// All rows, or only those with current (`with_zero_current` = false).
TransitionTable flatten(const Dataset& dataset, bool with_zero_current = false);

struct Split {
  Dataset train;
  Dataset validation;
  Dataset test;
};

/// Splits by whole episodes, drawn by `seed`; fractions of the episodes. Throws DataError when a part is
/// empty whose fraction is not 0.
Split split_by_episode(const Dataset& dataset, double validation_fraction, double test_fraction,
                       std::uint64_t seed);

/// Throws DataError naming the attribute when a scale, period, radius or unit cannot be.
void check_info(const DatasetInfo& info, const std::string& source);

/// The same, and naming episode, row and column when a number is NaN, infinite or out of all proportion (a
/// position 1 m away), a flag is neither 0 nor 1, sizes disagree, or the dataset holds no transition.
void check_dataset(const Dataset& dataset, const std::string& source);

}  // namespace lodestone::data
