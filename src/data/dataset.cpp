#include "lodestone/data/dataset.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/common/shown.h"

namespace lodestone::data {
namespace {

using common::DataError;

constexpr std::array<const char*, 3> kStateColumns = {"x_m", "y_m", "heading_rad"};

// Beyond these a number is in another unit, or garbage, and nothing can be learned from it.
constexpr double kFarthest_m = 1.0;            // a dish is a few centimetres wide
constexpr double kLargestHeading_rad = 100.0;  // some turns, where headings are not wrapped
constexpr double kLargestDrive = 10.0;         // action scales: a measured current overshoots the one set
constexpr double kLargestScale = 1e3;          // A or percent
constexpr double kLongestPeriod_s = 60.0;
constexpr std::int64_t kMostPlacements = 1000000;  // before one episode

[[noreturn]] void fail(const std::string& source, std::size_t episode, const std::string& what) {
  throw DataError(source + ": episode " + std::to_string(episode) + ": " + what);
}

void check_size(std::size_t found, std::size_t expected, const char* array, std::size_t episode,
                const std::string& source) {
  if (found != expected)
    fail(source, episode,
         std::string(array) + " holds " + std::to_string(found) + " numbers, expected " +
             std::to_string(expected) + " from the number of steps");
}

/// Every number is finite, and none of a column lies beyond its bound.
template <class Name, class Bound>
void check_numbers(const std::vector<double>& values, std::size_t columns, const char* array,
                   const Name& name_of, const Bound& bound_of, std::size_t episode,
                   const std::string& source) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t column = i % columns;
    if (!(std::abs(values[i]) <= bound_of(column)))
      fail(source, episode,
           fmt::format("{} row {}, column {} is {:g}; every number must be finite, and here at most {:g}",
                       array, i / columns, name_of(column), values[i], bound_of(column)));
  }
}

void check_flags(const std::vector<std::uint8_t>& flags, std::size_t steps, const char* array,
                 std::size_t episode, const std::string& source) {
  check_size(flags.size(), steps, array, episode, source);
  for (std::size_t i = 0; i < steps; ++i)
    if (flags[i] > 1)
      fail(source, episode, fmt::format("{} row {} is {}; a flag is 0 or 1", array, i, flags[i]));
}

void check_episode(const Episode& episode, const DatasetInfo& info, double farthest_m, std::size_t index,
                   const std::string& source) {
  const auto s = static_cast<std::size_t>(state_size(info.layout));
  const auto a = static_cast<std::size_t>(info.action_size);
  const std::size_t steps = episode.terminations.size();
  check_size(episode.observations.size(), (steps + 1) * s, "observations", index, source);
  check_size(episode.actions.size(), steps * a, "actions", index, source);
  check_flags(episode.terminations, steps, "terminations", index, source);
  check_flags(episode.truncations, steps, "truncations", index, source);
  check_flags(episode.zero_current, steps, "zero_current", index, source);
  const std::array<double, 3> farthest = {farthest_m, farthest_m, kLargestHeading_rad};
  check_numbers(
      episode.observations, s, "observations", [](std::size_t column) { return kStateColumns[column]; },
      [&farthest](std::size_t column) { return farthest[column]; }, index, source);
  if (episode.placements < 0 || episode.placements > kMostPlacements)
    fail(source, index,
         fmt::format("placements is {}; it must be within 0 and {}", episode.placements, kMostPlacements));
  const double drive = kLargestDrive * info.action_scale;
  check_numbers(
      episode.actions, a, "actions",
      [&info](std::size_t column) { return action_column(static_cast<int>(column), info.action_size); },
      [drive](std::size_t) { return drive; }, index, source);
}

}  // namespace

std::int64_t Dataset::transitions() const {
  return std::accumulate(episodes.begin(), episodes.end(), std::int64_t{0},
                         [](std::int64_t sum, const Episode& e) { return sum + e.length(); });
}

std::int64_t Dataset::placements() const {
  return std::accumulate(episodes.begin(), episodes.end(), std::int64_t{0},
                         [](std::int64_t sum, const Episode& e) { return sum + e.placements; });
}

Episode first_steps(const Episode& episode, std::int64_t steps) {
  LODESTONE_CHECK(steps >= 1 && steps <= episode.length(), "a part of the episode");
  const auto n = static_cast<std::size_t>(steps);
  Episode part = episode;
  part.observations.resize(episode.observations.size() / (episode.terminations.size() + 1) * (n + 1));
  part.actions.resize(episode.actions.size() / episode.terminations.size() * n);
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

double strongest(const double* action, int action_size) {
  double most = 0.0;
  for (int i = 0; i < action_size; ++i) most = std::max(most, std::abs(action[i]));
  return most;
}

TransitionTable flatten(const Dataset& dataset, bool with_zero_current) {
  TransitionTable table;
  table.state_size = state_size(dataset.info.layout);
  table.action_size = dataset.info.action_size;
  const auto s = static_cast<std::size_t>(table.state_size);
  const auto a = static_cast<std::size_t>(table.action_size);
  for (std::size_t e = 0; e < dataset.episodes.size(); ++e) {
    const Episode& episode = dataset.episodes[e];
    for (std::size_t t = 0; t < episode.terminations.size(); ++t) {
      if (!with_zero_current && episode.zero_current[t] != 0) continue;
      const double* row = episode.observations.data() + t * s;
      const double* action = episode.actions.data() + t * a;
      table.state.insert(table.state.end(), row, row + s);
      table.next_state.insert(table.next_state.end(), row + s, row + 2 * s);
      table.action.insert(table.action.end(), action, action + a);
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

void check_info(const DatasetInfo& info, const std::string& source) {
  const auto check = [&source](const char* name, double value, double largest) {
    if (!(value > 0.0 && value <= largest))
      throw DataError(
          fmt::format("{}: {} is {:g}, must be above 0 and at most {:g}", source, name, value, largest));
  };
  check("action_scale", info.action_scale, kLargestScale);
  check("workspace_radius_m", info.workspace_radius_m, kFarthest_m);
  check("control_period_s", info.control_period_s, kLongestPeriod_s);
  if (!common::is_utf8(info.source)) throw DataError(source + ": its attribute 'source' is no UTF-8");
  if (info.action_unit != "A" && info.action_unit != "percent")
    throw DataError(source + ": action_unit is \"" + common::shown(info.action_unit) +
                    "\", must be A or percent");
}

void check_dataset(const Dataset& dataset, const std::string& source) {
  if (dataset.transitions() == 0) throw DataError(source + ": holds no transition");
  check_info(dataset.info, source);
  for (std::size_t e = 0; e < dataset.episodes.size(); ++e)
    check_episode(dataset.episodes[e], dataset.info, kFarthest_m, e, source);
  for (std::size_t e = 0; e < dataset.impossible.size(); ++e)
    check_episode(dataset.impossible[e], dataset.info, kFarthestGlitch_m, e, source + ": impossible");
}

}  // namespace lodestone::data
