#pragma once

#include "lodestone/data/dataset.h"
#include "lodestone/env/episode_batch.h"
#include "paper_rig.h"

namespace lodestone::env::tests {

/// The paper's task as it stands, seen without a heading: four numbers of position and target.
inline EpisodeSettings plain_settings(std::int64_t count) {
  EpisodeSettings settings;
  settings.task = lodestone::tests::paper_task();
  settings.encoder = lodestone::tests::paper_encoder();
  settings.action = lodestone::tests::paper_action();
  settings.count = count;
  settings.encoder.heading = task::HeadingEncoding::kNone;
  settings.seed = 4;
  return settings;
}

/// Episodes whose step t of episode e drives (e, t) percent of the scale and moves 1 mm to the right.
inline data::Dataset recording() {
  data::Dataset dataset;
  dataset.info.layout = data::StateLayout::kPose;
  dataset.info.action_scale = 100.0;
  for (int e = 0; e < 4; ++e) {
    data::Episode episode;
    for (int t = 0; t <= 20; ++t) {
      episode.observations.insert(episode.observations.end(), {1e-3 * t - 0.01, 1e-3 * e, 0.1 * t});
      if (t == 20) break;
      episode.actions.insert(episode.actions.end(), {static_cast<double>(e), static_cast<double>(t)});
      episode.terminations.push_back(0);
      episode.truncations.push_back(t == 19 ? 1 : 0);
      episode.zero_current.push_back(0);
    }
    dataset.episodes.push_back(episode);
  }
  return dataset;
}

}  // namespace lodestone::env::tests
