#pragma once

#include <cstdint>
#include <vector>

#include <ATen/ATen.h>

#include "lodestone/common/random.h"
#include "lodestone/nets/tensors.h"
#include "lodestone/rl/replay_buffer.h"
#include "lodestone/rl/td3.h"

namespace lodestone::rl::tests {

/// Smooth numbers without meaning, float64.
inline at::Tensor wave(double phase, at::IntArrayRef shape) {
  std::int64_t count = 1;
  for (const std::int64_t n : shape) count *= n;
  return at::sin(0.11 * at::arange(count, at::kDouble) + 0.7 * phase).view(shape);
}

/// A batch of `rows` for six observed numbers and two actions; other ones for another phase. No end.
inline Batch wave_batch(std::int64_t rows, double phase, at::ScalarType type) {
  Batch batch(rows, 6, 2, type);
  batch.observation.copy_(wave(phase, {rows, 6}));
  batch.action.copy_(wave(phase + 1.0, {rows, 2}));
  batch.next_observation.copy_(wave(phase + 2.0, {rows, 6}));
  batch.reward.copy_(wave(phase + 3.0, {rows}));
  batch.not_done.fill_(1.0);
  return batch;
}

inline ReplayBuffer random_buffer(std::int64_t count, std::int64_t observation_size) {
  ReplayBuffer buffer(count, observation_size, 2);
  common::RandomStream random(5, "buffer");
  const auto draw = [&](std::int64_t columns) {
    std::vector<float> numbers(static_cast<std::size_t>(count * columns));
    for (float& number : numbers) number = static_cast<float>(random.uniform(-1, 1));
    return numbers;
  };
  env::StepResult result;
  const std::vector<float> observation = draw(observation_size);
  const std::vector<float> action = draw(2);
  result.final_observation = draw(observation_size);
  result.reward = draw(1);
  for (const float number : draw(1)) result.terminated.push_back(number > 0.8F ? 1 : 0);
  buffer.add(observation, action, result);
  return buffer;
}

inline bool identical(const nets::NamedTensors& one, const nets::NamedTensors& two) {
  if (one.size() != two.size()) return false;
  for (const auto& [name, tensor] : one) {
    if (!at::equal(tensor, two.at(name))) return false;
  }
  return true;
}

}  // namespace lodestone::rl::tests
