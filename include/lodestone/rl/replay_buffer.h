#pragma once

#include <cstdint>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/nets/checkpoint.h"

namespace lodestone::rl {

/// Transitions for one update, preallocated by the caller and filled by ReplayBuffer::sample.
struct Batch {
  Batch(std::int64_t size, std::int64_t observation_size, std::int64_t action_size,
        at::ScalarType type = at::kFloat);

  at::Tensor observation;       ///< [B, D]
  at::Tensor action;            ///< [B, A]
  at::Tensor reward;            ///< [B]
  at::Tensor next_observation;  ///< [B, D]
  at::Tensor not_done;  ///< [B] 0 where the episode terminated, 1 otherwise (truncated ones bootstrap)
};

/// Ring of the last `capacity` transitions, stored as one row each. That an episode was cut is not stored, as
/// it does not stop the bootstrap: the next observation is the true final one.
class ReplayBuffer {
 public:
  ReplayBuffer(std::int64_t capacity, std::int64_t observation_size, std::int64_t action_size);

  /// Adds one transition per environment: `observation` [N, D] and `action` [N, A] as they were before
  /// `result`. Throws LogicFault when they do not fit each other.
  void add(const std::vector<float>& observation, const std::vector<float>& action,
           const env::StepResult& result);

  /// Fills a float32 batch with rows drawn uniformly with replacement. Throws LogicFault when the buffer is
  /// empty.
  void sample(common::RandomStream& random, Batch& batch) const;

  std::int64_t size() const { return size_; }
  std::int64_t capacity() const { return capacity_; }

  /// Copies of the filled rows and the write position, and back. load throws CheckpointError on other sizes.
  nets::NamedTensors save() const;
  void load(const nets::NamedTensors& tensors);

 private:
  std::int64_t row_size() const { return 2 * observation_size_ + action_size_ + 2; }

  std::int64_t capacity_;
  std::int64_t observation_size_;
  std::int64_t action_size_;
  std::int64_t size_ = 0;
  std::int64_t next_ = 0;
  at::Tensor rows_;  // [capacity, row_size]: observation, action, next observation, reward, terminated
};

}  // namespace lodestone::rl
