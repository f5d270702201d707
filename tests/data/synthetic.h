#pragma once

#include "lodestone/common/random.h"
#include "lodestone/data/dataset.h"

namespace lodestone::tests {

/// Poses and drives drawn at random: `episodes` of `steps` each, one step in five without current.
inline data::Dataset random_dataset(int episodes, int steps, std::uint64_t seed = 1) {
  common::RandomStream random(seed, "tests/dataset");
  data::Dataset dataset;
  dataset.info.source = "test";
  dataset.info.workspace_radius_m = 0.0425;
  for (int e = 0; e < episodes; ++e) {
    data::Episode episode;
    for (int t = 0; t <= steps; ++t) {
      episode.observations.push_back(random.uniform(-0.03, 0.03));
      episode.observations.push_back(random.uniform(-0.03, 0.03));
      episode.observations.push_back(random.uniform(-3.1, 3.1));
    }
    for (int t = 0; t < steps; ++t) {
      const bool off = t % 5 == 4;
      episode.actions.push_back(off ? 0.0 : random.uniform(-15.0, 15.0));
      episode.actions.push_back(off ? 0.0 : random.uniform(-15.0, 15.0));
      episode.zero_current.push_back(off ? 1 : 0);
      episode.terminations.push_back(0);
      episode.truncations.push_back(t + 1 == steps ? 1 : 0);
    }
    dataset.episodes.push_back(std::move(episode));
  }
  return dataset;
}

}  // namespace lodestone::tests
