#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/env/vec_env.h"

namespace lodestone::env::tests {

/// Makes an environment with a number of threads; the same every time it is called. Its episodes must be
/// short enough that some reach the goal and some the step limit within 40 random steps, and its encoder must
/// put position first and target second (heading "none", target true), in metres times `1 / length_scale_m`.
struct ConformanceSubject {
  std::function<std::unique_ptr<VecEnv>(std::int64_t threads)> make;
  std::int64_t max_steps;
  double success_radius_m;
  double dish_radius_m;
  double length_scale_m;
};

inline std::vector<float> random_actions(const EnvSpec& spec, std::uint64_t step) {
  common::RandomStream random(99, "actions", step);
  std::vector<float> actions(static_cast<std::size_t>(spec.count * spec.action_size));
  for (float& action : actions) action = static_cast<float>(random.uniform(-1.0, 1.0));
  return actions;
}

inline bool same(const StepResult& a, const StepResult& b) {
  return a.observation == b.observation && a.reward == b.reward && a.terminated == b.terminated &&
         a.truncated == b.truncated && a.success == b.success && a.final_observation == b.final_observation &&
         a.action == b.action && a.penalty == b.penalty && a.progress == b.progress;
}

inline void check_sizes(VecEnv& environments) {
  const EnvSpec spec = environments.spec();
  const auto count = static_cast<std::size_t>(spec.count);
  const std::size_t numbers = count * static_cast<std::size_t>(spec.observation_size);
  CHECK(environments.reset().size() == numbers);
  const StepResult& result = environments.step(random_actions(spec, 0));
  CHECK(result.observation.size() == numbers);
  CHECK(result.final_observation.size() == numbers);
  CHECK(result.reward.size() == count);
  for (const auto* flags : {&result.terminated, &result.truncated, &result.success})
    CHECK(flags->size() == count);
  for (const auto* each : {&result.penalty, &result.progress}) CHECK(each->size() == count);
  CHECK_THROWS_AS(environments.step(std::vector<float>(3 * count)), common::LogicFault);
  CHECK_THROWS_AS(environments.step(std::vector<float>(2 * (count + 1))), common::LogicFault);
}

/// Follows every episode by itself and compares each end with the rules.
inline void check_episodes(const ConformanceSubject& subject) {
  const std::unique_ptr<VecEnv> environments = subject.make(2);
  const EnvSpec spec = environments->spec();
  std::vector<float> before = environments->reset();
  std::vector<std::int64_t> age(static_cast<std::size_t>(spec.count), 0);
  std::int64_t reached = 0;
  std::int64_t cut = 0;
  for (std::uint64_t step = 0; step < 40; ++step) {
    const StepResult& result = environments->step(random_actions(spec, step));
    const auto columns = static_cast<std::size_t>(spec.observation_size);
    for (std::size_t i = 0; i < age.size(); ++i) {
      const float* now = &result.final_observation[i * columns];
      const float* then = &before[i * columns];
      const float* next = &result.observation[i * columns];
      const auto distance_m = [&](const float* row) {
        return subject.length_scale_m * std::hypot(row[0] - row[2], row[1] - row[3]);
      };
      const bool inside = distance_m(now) < subject.success_radius_m;
      const bool outside = subject.length_scale_m * std::hypot(now[0], now[1]) > subject.dish_radius_m;
      const bool terminated = result.terminated[i] == 1;
      const bool truncated = result.truncated[i] == 1;
      const std::int64_t steps = ++age[i];
      CHECK((result.success[i] == 1) == inside);
      CHECK(terminated == (inside || outside));
      CHECK(truncated == (!terminated && steps == subject.max_steps));
      const double reward =
          -10.0 * (distance_m(now) - distance_m(then)) / subject.dish_radius_m + (inside ? 10.0 : 0.0) - 0.04;
      CHECK(result.reward[i] == Approx(reward).margin(1e-4));
      // The goal stays for the episode, also in the final observation; only a new episode brings a new one.
      CHECK(now[2] == then[2]);
      CHECK(now[3] == then[3]);
      if (terminated || truncated) {
        age[i] = 0;
        CHECK_FALSE(std::equal(now, now + columns, next));
        reached += inside ? 1 : 0;
        cut += truncated ? 1 : 0;
      } else {
        CHECK(std::equal(now, now + columns, next));
      }
    }
    before = result.observation;
  }
  CHECK(reached > 0);
  CHECK(cut > 0);
}

inline void check_determinism(const ConformanceSubject& subject) {
  std::vector<std::vector<StepResult>> runs;
  for (const std::int64_t threads : {1, 2, 4, 1}) {
    const std::unique_ptr<VecEnv> environments = subject.make(threads);
    std::vector<StepResult> run;
    environments->reset();
    for (std::uint64_t step = 0; step < 12; ++step) {
      run.push_back(environments->step(random_actions(environments->spec(), step)));
    }
    runs.push_back(std::move(run));
  }
  for (std::size_t run = 1; run < runs.size(); ++run) {
    for (std::size_t step = 0; step < runs[run].size(); ++step) CHECK(same(runs[0][step], runs[run][step]));
  }
  CHECK_FALSE(runs[0][0].observation == runs[0][1].observation);
}

inline void check_resume(const ConformanceSubject& subject) {
  const std::unique_ptr<VecEnv> environments = subject.make(2);
  const EnvSpec spec = environments->spec();
  environments->reset();
  for (std::uint64_t step = 0; step < 7; ++step) environments->step(random_actions(spec, step));
  const Snapshot snapshot = environments->save();
  for (std::uint64_t step = 7; step < 9; ++step) environments->step(random_actions(spec, step));
  environments->load(snapshot);  // a snapshot stays as it was
  const std::unique_ptr<VecEnv> resumed = subject.make(1);
  resumed->load(snapshot);
  for (std::uint64_t step = 7; step < 25; ++step) {
    const std::vector<float> actions = random_actions(spec, step);
    CHECK(same(environments->step(actions), resumed->step(actions)));
  }
  CHECK(environments->reset() == resumed->reset());
  CHECK_THROWS_AS(resumed->load({}), common::CheckpointError);
}

/// Everything a VecEnv promises.
inline void check_vec_env(const ConformanceSubject& subject) {
  check_sizes(*subject.make(1));
  check_episodes(subject);
  check_determinism(subject);
  check_resume(subject);
}

}  // namespace lodestone::env::tests
