#include "lodestone/env/replay_env.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/sample_settings.h"
#include "env/vec_env_conformance.h"
#include "lodestone/common/error.h"

namespace lodestone::env {
namespace {

EpisodeSettings replay_settings_for(std::int64_t count) {
  EpisodeSettings settings = tests::plain_settings(count);
  settings.task.end_on_success = false;
  return settings;
}

TEST_CASE("recorded steps come back as they were, in stretches of 10 to 15", "[unit]") {
  ReplayEnv replay(tests::recording(), replay_settings_for(30), {});
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
  CHECK_THROWS_AS(ReplayEnv(tests::recording(), replay_settings_for(2), config), common::ConfigError);
  config.longest = 20;
  CHECK_THROWS_AS(ReplayEnv(tests::recording(), replay_settings_for(2), config), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::env
