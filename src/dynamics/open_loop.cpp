#include "open_loop.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/mean_pose.h"

namespace lodestone::dynamics {
namespace {

constexpr auto& kSteps = runs::OpenLoopError::kSteps;

/// A place in a dataset from which a predictor runs on by itself.
struct Chain {
  const data::Episode* episode;
  std::int64_t first;
};

/// A row of `columns` numbers.
auto row(const std::vector<double>& rows, std::int64_t index, std::size_t columns) {
  return rows.begin() + static_cast<std::ptrdiff_t>(columns) * index;
}

/// Means [N, S] of states [N, draws, S].
std::vector<double> means(const std::vector<double>& states, std::size_t size, std::int64_t draws) {
  if (draws == 1) return states;
  std::vector<double> result;
  std::vector<geometry::Pose2> poses(static_cast<std::size_t>(draws));
  for (std::size_t i = 0; i < states.size();) {
    for (geometry::Pose2& pose : poses) {
      pose = {states[i], states[i + 1], size == 3 ? states[i + 2] : 0.0};
      i += size;
    }
    const geometry::Pose2 mean = geometry::mean_pose(poses);
    const double numbers[] = {mean.x_m, mean.y_m, mean.heading_rad};
    result.insert(result.end(), numbers, numbers + size);
  }
  return result;
}

}  // namespace

runs::StateError state_error(const std::vector<double>& predicted, const std::vector<double>& actual,
                             int state_size) {
  const auto stride = static_cast<std::size_t>(state_size);
  const auto rows = static_cast<double>(actual.size() / stride);
  double position_m2 = 0.0;
  double heading_rad2 = 0.0;
  for (std::size_t i = 0; i < actual.size(); i += stride) {
    position_m2 += std::pow(predicted[i] - actual[i], 2) + std::pow(predicted[i + 1] - actual[i + 1], 2);
    if (state_size == 3) heading_rad2 += std::pow(geometry::wrap_angle(predicted[i + 2] - actual[i + 2]), 2);
  }
  runs::StateError error;
  error.position_rms_mm = geometry::kMmPerM * std::sqrt(position_m2 / rows);
  if (state_size == 3) error.heading_rms_deg = geometry::kDegPerRad * std::sqrt(heading_rad2 / rows);
  return error;
}

runs::OpenLoopError open_loop_error(const Predictor& predictor, const data::Dataset& dataset,
                                    std::int64_t draws) {
  const int state_size = data::state_size(dataset.info.layout);
  const auto size = static_cast<std::size_t>(state_size);
  const auto numbers = static_cast<std::size_t>(dataset.info.action_size);
  std::vector<Chain> chains;
  std::vector<double> state;  // [chains, draws, S]
  for (const data::Episode& episode : dataset.episodes) {
    for (std::int64_t t = 0; t < episode.length(); ++t) {
      chains.push_back({&episode, t});
      const auto at = row(episode.observations, t, size);
      for (std::int64_t k = 0; k < draws; ++k)
        state.insert(state.end(), at, at + static_cast<std::ptrdiff_t>(size));
    }
  }
  const std::size_t stride = size * static_cast<std::size_t>(draws);
  runs::OpenLoopError::BySteps position;
  runs::OpenLoopError::BySteps heading;
  for (int step = 1; step <= *std::rbegin(kSteps); ++step) {
    std::vector<Chain> kept;
    std::vector<double> kept_state;
    std::vector<double> action;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      if (chains[i].first + step > chains[i].episode->length()) continue;
      kept.push_back(chains[i]);
      const auto at = row(state, static_cast<std::int64_t>(i), stride);
      kept_state.insert(kept_state.end(), at, at + static_cast<std::ptrdiff_t>(stride));
      const auto drive = row(chains[i].episode->actions, chains[i].first + step - 1, numbers);
      for (std::int64_t k = 0; k < draws; ++k)
        action.insert(action.end(), drive, drive + static_cast<std::ptrdiff_t>(numbers));
    }
    chains = std::move(kept);
    state = chains.empty() ? std::vector<double>{} : predictor(kept_state, action);
    std::vector<double> truth;
    for (std::size_t i = 0; i < chains.size(); ++i) {
      const double* drive = &action[i * static_cast<std::size_t>(draws) * numbers];
      const bool zero = data::strongest(drive, dataset.info.action_size) == 0.0;
      const auto at = static_cast<std::ptrdiff_t>(i * stride);
      if (zero) std::copy_n(kept_state.begin() + at, stride, state.begin() + at);
      const auto seen = row(chains[i].episode->observations, chains[i].first + step, size);
      truth.insert(truth.end(), seen, seen + static_cast<std::ptrdiff_t>(size));
    }
    if (std::find(std::begin(kSteps), std::end(kSteps), step) == std::end(kSteps)) continue;
    position[step] = std::nullopt;
    heading[step] = std::nullopt;
    if (chains.empty()) continue;
    const runs::StateError error = state_error(means(state, size, draws), truth, state_size);
    position[step] = error.position_rms_mm;
    heading[step] = error.heading_rms_deg;
  }
  runs::OpenLoopError errors;
  errors.k_step_mm = std::move(position);
  if (state_size == 3) errors.k_step_heading_deg = std::move(heading);
  return errors;
}

}  // namespace lodestone::dynamics
