#include "lodestone/env/replay_env.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "env/vec_env_conformance.h"
#include "lodestone/common/error.h"
#include "lodestone/env/joined_env.h"
#include "lodestone/env/mbs_env.h"
#include "paper_rig.h"

namespace lodestone::env {
namespace {

/// Episodes whose step t of episode e drives (e, t) percent of the scale and moves 1 mm to the right.
data::Dataset recording() {
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

EpisodeSettings settings_for(std::int64_t count) {
  EpisodeSettings settings;
  settings.task = lodestone::tests::paper_task();
  settings.encoder = lodestone::tests::paper_encoder();
  settings.action = lodestone::tests::paper_action();
  settings.count = count;
  settings.encoder.heading = task::HeadingEncoding::kNone;
  settings.task.end_on_success = false;
  settings.seed = 4;
  return settings;
}

TEST_CASE("recorded steps come back as they were, in stretches of 10 to 15", "[unit]") {
  ReplayEnv replay(recording(), settings_for(30), {});
  std::vector<float> before = replay.reset();
  std::vector<int> length(30, 0);
  for (std::uint64_t step = 0; step < 60; ++step) {
    const StepResult& result = replay.step(tests::random_actions(replay.spec(), step));
    REQUIRE(result.action.size() == 60);
    for (std::size_t i = 0; i < 30; ++i) {
      const float* from = &before[4 * i];
      const float* to = &result.final_observation[4 * i];
      // 1 mm to the right in every step, and the action that the episode and the step say
      REQUIRE(0.0425 * (to[0] - from[0]) == Approx(1e-3).epsilon(1e-3));
      REQUIRE(result.action[2 * i] == Approx(std::round(42.5 * from[1]) / 100.0).margin(1e-6));
      REQUIRE(result.action[2 * i + 1] == Approx(std::round(42.5 * from[0] + 10.0) / 100.0).margin(1e-6));
      ++length[i];
      CHECK_FALSE(result.terminated[i] != 0);
      if (result.truncated[i] == 0) continue;
      CHECK(length[i] >= 10);
      CHECK(length[i] <= 15);
      length[i] = 0;
    }
    before = result.observation;
  }
}

TEST_CASE("a recording without a long enough episode is refused", "[unit]") {
  ReplayConfig config;
  config.shortest = 25;
  config.longest = 30;
  CHECK_THROWS_AS(ReplayEnv(recording(), settings_for(2), config), common::ConfigError);
  config.longest = 20;
  CHECK_THROWS_AS(ReplayEnv(recording(), settings_for(2), config), common::ConfigError);
}

TEST_CASE("joined environments are their parts, one after the other, and resume bitwise", "[unit]") {
  const inference::DynamicsModel model = tests::linear_model(data::StateLayout::kPose, {1e-3}, {0.0});
  const auto make = [&] {
    std::vector<std::unique_ptr<VecEnv>> parts;
    parts.push_back(std::make_unique<MbsEnv>(model, settings_for(3), MbsConfig(), 1));
    parts.push_back(std::make_unique<ReplayEnv>(recording(), settings_for(2), ReplayConfig()));
    return JoinedEnv(std::move(parts));
  };
  JoinedEnv joined = make();
  JoinedEnv other = make();
  CHECK(joined.spec().count == 5);
  joined.reset();
  for (std::uint64_t step = 0; step < 7; ++step) joined.step(tests::random_actions(joined.spec(), step));
  other.load(joined.save());
  for (std::uint64_t step = 7; step < 40; ++step) {
    const std::vector<float> actions = tests::random_actions(joined.spec(), step);
    const StepResult& result = joined.step(actions);
    REQUIRE(tests::same(result, other.step(actions)));
    CHECK(std::equal(actions.begin(), actions.begin() + 6, result.action.begin()));
    CHECK_FALSE(std::equal(actions.begin() + 6, actions.end(), result.action.begin() + 6));
  }
  CHECK_THROWS_AS(other.load({}), common::CheckpointError);
}

}  // namespace
}  // namespace lodestone::env
