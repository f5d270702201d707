#include "lodestone/data/dataset.h"

#include <array>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

namespace lodestone::data {
namespace {

using common::DataError;

constexpr std::array<const char*, 3> kStateColumns = {"x_m", "y_m", "heading_rad"};
constexpr std::array<const char*, 2> kActionColumns = {"drive_x", "drive_y"};

[[noreturn]] void fail(const std::string& source, std::size_t episode, const std::string& what) {
  throw DataError(source + ": episode " + std::to_string(episode) + ": " + what);
}

template <std::size_t N>
void check_finite(const std::vector<double>& values, std::size_t columns, const char* array,
                  const std::array<const char*, N>& names, std::size_t episode, const std::string& source) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      fail(source, episode,
           std::string(array) + " row " + std::to_string(i / columns) + ", column " + names[i % columns] +
               " is " + std::to_string(values[i]) + "; every number must be finite");
}

void check_size(std::size_t found, std::size_t expected, const char* array, std::size_t episode,
                const std::string& source) {
  if (found != expected)
    fail(source, episode,
         std::string(array) + " holds " + std::to_string(found) + " numbers, expected " +
             std::to_string(expected) + " from the number of steps");
}

}  // namespace

std::int64_t Dataset::transitions() const {
  return std::accumulate(episodes.begin(), episodes.end(), std::int64_t{0},
                         [](std::int64_t sum, const Episode& e) { return sum + e.length(); });
}

Episode first_steps(const Episode& episode, std::int64_t steps) {
  LODESTONE_CHECK(steps >= 1 && steps <= episode.length(), "a part of the episode");
  const auto n = static_cast<std::size_t>(steps);
  Episode part = episode;
  part.observations.resize(episode.observations.size() / (episode.terminations.size() + 1) * (n + 1));
  part.actions.resize(kActionSize * n);
  part.terminations.resize(n);
  part.truncations.resize(n);
  part.zero_current.resize(n);
  if (part.terminations.back() == 0) part.truncations.back() = 1;
  return part;
}

Dataset first_transitions(Dataset dataset, std::int64_t count) {
  LODESTONE_CHECK(count >= 1, "at least one transition");
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < dataset.episodes.size(); ++i) {
    Episode& episode = dataset.episodes[i];
    if (seen + episode.length() < count) {
      seen += episode.length();
      continue;
    }
    if (seen + episode.length() > count) episode = first_steps(episode, count - seen);
    dataset.episodes.resize(i + 1);
    break;
  }
  return dataset;
}

TransitionTable flatten(const Dataset& dataset, bool with_zero_current) {
  TransitionTable table;
  table.state_size = state_size(dataset.info.layout);
  const auto s = static_cast<std::size_t>(table.state_size);
  for (std::size_t e = 0; e < dataset.episodes.size(); ++e) {
    const Episode& episode = dataset.episodes[e];
    for (std::size_t t = 0; t < episode.terminations.size(); ++t) {
      if (!with_zero_current && episode.zero_current[t] != 0) continue;
      const double* row = episode.observations.data() + t * s;
      const double* action = episode.actions.data() + t * kActionSize;
      table.state.insert(table.state.end(), row, row + s);
      table.next_state.insert(table.next_state.end(), row + s, row + 2 * s);
      table.action.insert(table.action.end(), action, action + kActionSize);
      table.episode.push_back(static_cast<std::int64_t>(e));
    }
  }
  return table;
}

Split split_by_episode(const Dataset& dataset, double validation_fraction, double test_fraction,
                       std::uint64_t seed) {
  const std::size_t n = dataset.episodes.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  common::RandomStream random(seed, "data/split");
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);

  const auto count_of = [n](double fraction) {
    return static_cast<std::size_t>(std::llround(fraction * static_cast<double>(n)));
  };
  const std::size_t n_test = count_of(test_fraction);
  const std::size_t n_validation = count_of(validation_fraction);
  const auto too_small = [&](const char* part, double fraction) {
    throw DataError("a dataset of " + std::to_string(n) + " episodes leaves no episode for the " + part +
                    " part (fraction " + std::to_string(fraction) +
                    "): record more, or change the fractions");
  };
  if (n_test == 0 && test_fraction > 0.0) too_small("test", test_fraction);
  if (n_validation == 0 && validation_fraction > 0.0) too_small("validation", validation_fraction);
  if (n_test + n_validation >= n) too_small("training", 1.0 - validation_fraction - test_fraction);

  Split split;
  split.train.info = split.validation.info = split.test.info = dataset.info;
  for (std::size_t i = 0; i < n; ++i) {
    Dataset& part = i < n_test ? split.test : i < n_test + n_validation ? split.validation : split.train;
    part.episodes.push_back(dataset.episodes[order[i]]);
  }
  return split;
}

void check_dataset(const Dataset& dataset, const std::string& source) {
  if (dataset.transitions() == 0) throw DataError(source + ": holds no transition");
  if (!(dataset.info.action_scale > 0.0) || !std::isfinite(dataset.info.action_scale))
    throw DataError(source + ": action_scale is " + std::to_string(dataset.info.action_scale) +
                    ", must be above 0");
  if (!(dataset.info.workspace_radius_m > 0.0) || !std::isfinite(dataset.info.workspace_radius_m))
    throw DataError(source + ": workspace_radius_m is " + std::to_string(dataset.info.workspace_radius_m) +
                    ", must be above 0");
  const auto s = static_cast<std::size_t>(state_size(dataset.info.layout));
  for (std::size_t e = 0; e < dataset.episodes.size(); ++e) {
    const Episode& episode = dataset.episodes[e];
    const std::size_t steps = episode.terminations.size();
    check_size(episode.observations.size(), (steps + 1) * s, "observations", e, source);
    check_size(episode.actions.size(), steps * kActionSize, "actions", e, source);
    check_size(episode.truncations.size(), steps, "truncations", e, source);
    check_size(episode.zero_current.size(), steps, "zero_current", e, source);
    check_finite(episode.observations, s, "observations", kStateColumns, e, source);
    check_finite(episode.actions, kActionSize, "actions", kActionColumns, e, source);
  }
}

}  // namespace lodestone::data
