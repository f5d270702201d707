#include "impossible_rows.h"

#include <cmath>

namespace lodestone::data {
namespace {

/// Steps `first` to `last` (exclusive) of an episode, cut at their end.
Episode steps_of(const Episode& episode, std::size_t first, std::size_t last, std::size_t state_size,
                 std::size_t action_size) {
  const auto part = [](const auto& values, std::size_t from, std::size_t to) {
    using Offset = std::ptrdiff_t;
    return std::decay_t<decltype(values)>(values.begin() + static_cast<Offset>(from),
                                          values.begin() + static_cast<Offset>(to));
  };
  Episode out;
  out.observations = part(episode.observations, first * state_size, (last + 1) * state_size);
  out.actions = part(episode.actions, first * action_size, last * action_size);
  out.terminations = part(episode.terminations, first, last);
  out.truncations = part(episode.truncations, first, last);
  out.zero_current = part(episode.zero_current, first, last);
  if (out.terminations.back() == 0) out.truncations.back() = 1;
  out.placements = first == 0 ? episode.placements : 0;
  return out;
}

}  // namespace

std::vector<ImpossiblePosition> separate_impossible(Dataset& dataset,
                                                    const std::vector<std::vector<std::int64_t>>& lines,
                                                    double limit_m) {
  const auto s = static_cast<std::size_t>(state_size(dataset.info.layout));
  const auto a = static_cast<std::size_t>(dataset.info.action_size);
  std::vector<ImpossiblePosition> found;
  std::vector<Episode> possible;
  for (std::size_t e = 0; e < dataset.episodes.size(); ++e) {
    const Episode& episode = dataset.episodes[e];
    const auto radius_m = [&](std::size_t row) {
      return std::hypot(episode.observations[row * s], episode.observations[row * s + 1]);
    };
    const auto steps = static_cast<std::size_t>(episode.length());
    std::size_t first = 0;  // of the steps since the last impossible position
    for (std::size_t row = 0; row <= steps; ++row) {
      if (radius_m(row) <= limit_m) continue;
      found.push_back({lines[e][row], radius_m(row)});
      if (row > first + 1) possible.push_back(steps_of(episode, first, row - 1, s, a));
      // The step to here, unless the step before has taken it, and the step from here.
      if (row > 0 && row > first) dataset.impossible.push_back(steps_of(episode, row - 1, row, s, a));
      if (row < steps) dataset.impossible.push_back(steps_of(episode, row, row + 1, s, a));
      first = row + 1;
    }
    if (first < steps) possible.push_back(steps_of(episode, first, steps, s, a));
  }
  dataset.episodes = std::move(possible);
  return found;
}

}  // namespace lodestone::data
