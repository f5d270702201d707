#pragma once

#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <torch/torch.h>

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

inline torch::Tensor random_actions(const EnvSpec& spec, std::uint64_t step) {
  common::RandomStream random(99, "actions", step);
  torch::Tensor actions = torch::empty({spec.count, spec.action_size});
  float* values = actions.data_ptr<float>();
  for (std::int64_t i = 0; i < actions.numel(); ++i)
    values[i] = static_cast<float>(random.uniform(-1.0, 1.0));
  return actions;
}

inline StepResult copy_of(const StepResult& result) {
  return {result.observation.clone(),
          result.reward.clone(),
          result.terminated.clone(),
          result.truncated.clone(),
          result.success.clone(),
          result.final_observation.clone(),
          result.action.defined() ? result.action.clone() : torch::Tensor()};
}

inline bool same(const StepResult& a, const StepResult& b) {
  return torch::equal(a.observation, b.observation) && torch::equal(a.reward, b.reward) &&
         torch::equal(a.terminated, b.terminated) && torch::equal(a.truncated, b.truncated) &&
         torch::equal(a.success, b.success) && torch::equal(a.final_observation, b.final_observation);
}

inline void check_shapes(VecEnv& environments) {
  const EnvSpec spec = environments.spec();
  CHECK(environments.reset().sizes() == torch::IntArrayRef({spec.count, spec.observation_size}));
  const StepResult result = environments.step(random_actions(spec, 0));
  CHECK(result.observation.sizes() == torch::IntArrayRef({spec.count, spec.observation_size}));
  CHECK(result.final_observation.sizes() == torch::IntArrayRef({spec.count, spec.observation_size}));
  CHECK(result.reward.scalar_type() == torch::kFloat32);
  for (const torch::Tensor& flags : {result.terminated, result.truncated, result.success}) {
    CHECK(flags.sizes() == torch::IntArrayRef({spec.count}));
    CHECK(flags.scalar_type() == torch::kUInt8);
  }
  CHECK_THROWS_AS(environments.step(torch::zeros({spec.count, 3})), common::LogicFault);
  CHECK_THROWS_AS(environments.step(torch::zeros({spec.count, 2}, torch::kFloat64)), common::LogicFault);
  CHECK_THROWS_AS(environments.step(torch::zeros({spec.count + 1, 2})), common::LogicFault);
}

/// Follows every episode by itself and compares each end with the rules.
inline void check_episodes(const ConformanceSubject& subject) {
  const std::unique_ptr<VecEnv> environments = subject.make(2);
  const EnvSpec spec = environments->spec();
  torch::Tensor before = environments->reset().clone();
  std::vector<std::int64_t> age(static_cast<std::size_t>(spec.count), 0);
  std::int64_t reached = 0;
  std::int64_t cut = 0;
  for (std::uint64_t step = 0; step < 40; ++step) {
    const StepResult result = copy_of(environments->step(random_actions(spec, step)));
    for (std::int64_t i = 0; i < spec.count; ++i) {
      const float* now = result.final_observation.data_ptr<float>() + i * spec.observation_size;
      const float* then = before.data_ptr<float>() + i * spec.observation_size;
      const auto distance_m = [&](const float* row) {
        return subject.length_scale_m * std::hypot(row[0] - row[2], row[1] - row[3]);
      };
      const bool inside = distance_m(now) < subject.success_radius_m;
      const bool outside = subject.length_scale_m * std::hypot(now[0], now[1]) > subject.dish_radius_m;
      const bool terminated = result.terminated[i].item<int>() == 1;
      const bool truncated = result.truncated[i].item<int>() == 1;
      const std::int64_t steps = ++age[static_cast<std::size_t>(i)];
      CHECK((result.success[i].item<int>() == 1) == inside);
      CHECK(terminated == (inside || outside));
      CHECK(truncated == (!terminated && steps == subject.max_steps));
      const double reward =
          -10.0 * (distance_m(now) - distance_m(then)) / subject.dish_radius_m + (inside ? 10.0 : 0.0) - 0.04;
      CHECK(result.reward[i].item<double>() == Approx(reward).margin(1e-4));
      // The goal stays for the episode, also in the final observation; only a new episode brings a new one.
      CHECK(now[2] == then[2]);
      CHECK(now[3] == then[3]);
      if (terminated || truncated) {
        age[static_cast<std::size_t>(i)] = 0;
        CHECK_FALSE(torch::equal(result.observation[i], result.final_observation[i]));
        reached += inside ? 1 : 0;
        cut += truncated ? 1 : 0;
      } else {
        CHECK(torch::equal(result.observation[i], result.final_observation[i]));
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
      run.push_back(copy_of(environments->step(random_actions(environments->spec(), step))));
    }
    runs.push_back(std::move(run));
  }
  for (std::size_t run = 1; run < runs.size(); ++run) {
    for (std::size_t step = 0; step < runs[run].size(); ++step) CHECK(same(runs[0][step], runs[run][step]));
  }
  CHECK_FALSE(torch::equal(runs[0][0].observation, runs[0][1].observation));
}

inline void check_resume(const ConformanceSubject& subject) {
  const std::unique_ptr<VecEnv> environments = subject.make(2);
  const EnvSpec spec = environments->spec();
  environments->reset();
  for (std::uint64_t step = 0; step < 7; ++step) environments->step(random_actions(spec, step));
  EnvState state;
  environments->exchange_state(state, false);
  for (auto& entry : state.tensors) entry.second = entry.second.clone();
  const std::unique_ptr<VecEnv> resumed = subject.make(1);
  resumed->exchange_state(state, true);
  for (std::uint64_t step = 7; step < 25; ++step) {
    const torch::Tensor actions = random_actions(spec, step);
    CHECK(same(environments->step(actions), resumed->step(actions)));
  }
  CHECK(torch::equal(environments->reset(), resumed->reset()));
  EnvState empty;
  CHECK_THROWS_AS(resumed->exchange_state(empty, true), common::CheckpointError);
}

/// Everything a VecEnv promises.
inline void check_vec_env(const ConformanceSubject& subject) {
  check_shapes(*subject.make(1));
  check_episodes(subject);
  check_determinism(subject);
  check_resume(subject);
}

}  // namespace lodestone::env::tests
