#pragma once

#include <cmath>
#include <cstdint>

#include "lodestone/common/random.h"
#include "lodestone/data/dataset.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::dynamics::tests {

/// Next state of a made-up robot whose law is known: it slides along each axis with the drive, more so off
/// the centre, and, where it has one, turns its heading.
inline void known_motion(const double* state, const double* action, int size, double* next) {
  next[0] = state[0] + 4e-4 * action[0] * (1.0 + 8.0 * state[1]);
  next[1] = state[1] + 4e-4 * action[1] * (1.0 - 8.0 * state[0]);
  if (size == 3) {
    next[2] = geometry::wrap_angle(state[2] +
                                   0.03 * (action[1] * std::cos(state[2]) - action[0] * std::sin(state[2])));
  }
}

/// `episodes` episodes of `steps` pulses each; one pulse in ten has no current and moves nothing.
inline data::Dataset known_dataset(data::StateLayout layout, std::int64_t episodes, std::int64_t steps,
                                   std::uint64_t seed) {
  common::RandomStream random(seed, "known dataset");
  const int size = data::state_size(layout);
  data::Dataset dataset;
  dataset.info.layout = layout;
  dataset.info.source = "known motion";
  dataset.info.workspace_radius_m = 0.0425;
  for (std::int64_t e = 0; e < episodes; ++e) {
    data::Episode episode;
    double state[3] = {random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), 0.0};
    if (size == 3) state[2] = random.uniform(-3.1, 3.1);
    for (int d = 0; d < size; ++d) episode.observations.push_back(state[d]);
    for (std::int64_t t = 0; t < steps; ++t) {
      const bool zero = random.below(10) == 0;
      const double action[2] = {zero ? 0.0 : random.uniform(-10.0, 10.0),
                                zero ? 0.0 : random.uniform(-10.0, 10.0)};
      double next[3] = {0.0, 0.0, 0.0};
      known_motion(state, action, size, next);
      for (int d = 0; d < size; ++d) episode.observations.push_back(state[d] = next[d]);
      for (const double drive : action) episode.actions.push_back(drive);
      episode.terminations.push_back(0);
      episode.truncations.push_back(t + 1 == steps ? 1 : 0);
      episode.zero_current.push_back(zero ? 1 : 0);
    }
    dataset.episodes.push_back(episode);
  }
  return dataset;
}

}  // namespace lodestone::dynamics::tests
