#include "lodestone/rl/replay_buffer.h"

#include <algorithm>
#include <string>

#include <ATen/TensorOperators.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/full.h>
#include <ATen/ops/zeros.h>
#include <c10/util/StringUtil.h>

#include "lodestone/common/error.h"

namespace lodestone::rl {

Batch::Batch(std::int64_t size, std::int64_t observation_size, std::int64_t action_size, at::ScalarType type)
    : observation(at::zeros({size, observation_size}, type)),
      action(at::zeros({size, action_size}, type)),
      reward(at::zeros({size}, type)),
      next_observation(at::zeros({size, observation_size}, type)),
      not_done(at::zeros({size}, type)) {}

ReplayBuffer::ReplayBuffer(std::int64_t capacity, std::int64_t observation_size, std::int64_t action_size)
    : capacity_(capacity), observation_size_(observation_size), action_size_(action_size) {
  LODESTONE_CHECK(capacity > 0 && observation_size > 0 && action_size > 0,
                  "replay buffer sizes must be positive, capacity is " + std::to_string(capacity));
  rows_ = at::zeros({capacity, row_size()}, at::kFloat);
}

void ReplayBuffer::add(const std::vector<float>& observation, const std::vector<float>& action,
                       const env::StepResult& result) {
  const std::size_t count = result.reward.size();
  const auto check = [count](std::size_t size, std::int64_t columns, const char* name) {
    LODESTONE_CHECK(size == count * static_cast<std::size_t>(columns),
                    std::string("replay buffer: ") + name + " holds " + std::to_string(size) +
                        " numbers for " + std::to_string(count) + " rows of " + std::to_string(columns));
  };
  check(observation.size(), observation_size_, "observation");
  check(action.size(), action_size_, "action");
  check(result.final_observation.size(), observation_size_, "final observation");
  check(result.terminated.size(), 1, "terminated");
  const float* before = observation.data();
  const float* act = action.data();
  const float* after = result.final_observation.data();
  for (std::size_t i = 0; i < count; ++i) {
    float* row = rows_.data_ptr<float>() + next_ * row_size();
    row = std::copy_n(before, observation_size_, row);
    row = std::copy_n(act, action_size_, row);
    row = std::copy_n(after, observation_size_, row);
    before += observation_size_;
    act += action_size_;
    after += observation_size_;
    row[0] = result.reward[i];
    row[1] = result.terminated[i] != 0 ? 1.0F : 0.0F;
    next_ = (next_ + 1) % capacity_;
    size_ = std::min(size_ + 1, capacity_);
  }
}

void ReplayBuffer::sample(common::RandomStream& random, Batch& batch) const {
  LODESTONE_CHECK(size_ > 0, "replay buffer is empty: collect before sampling");
  const std::int64_t count = batch.reward.size(0);
  nets::check_tensor(batch.observation, {count, observation_size_}, at::kFloat,
                     "replay buffer: batch observation");
  nets::check_tensor(batch.action, {count, action_size_}, at::kFloat, "replay buffer: batch action");
  float* observation = batch.observation.data_ptr<float>();
  float* action = batch.action.data_ptr<float>();
  float* next = batch.next_observation.data_ptr<float>();
  float* reward = batch.reward.data_ptr<float>();
  float* not_done = batch.not_done.data_ptr<float>();
  for (std::int64_t i = 0; i < count; ++i) {
    const auto drawn = static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(size_)));
    const float* row = rows_.data_ptr<float>() + drawn * row_size();
    observation = std::copy_n(row, observation_size_, observation);
    row += observation_size_;
    action = std::copy_n(row, action_size_, action);
    row += action_size_;
    next = std::copy_n(row, observation_size_, next);
    row += observation_size_;
    reward[i] = row[0];
    not_done[i] = 1.0F - row[1];
  }
}

nets::NamedTensors ReplayBuffer::save() const {
  return {{"rows", rows_.narrow(0, 0, size_).clone()}, {"next", at::tensor({next_}, at::kLong)}};
}

void ReplayBuffer::load(const nets::NamedTensors& tensors) {
  const auto rows = tensors.find("rows");
  const auto next = tensors.find("next");
  if (rows == tensors.end() || next == tensors.end()) {
    throw common::CheckpointError(
        "replay buffer: tensor \"rows\" or \"next\" is missing from the checkpoint");
  }
  const at::Tensor& stored = rows->second;
  if (stored.dim() != 2 || stored.size(1) != row_size() || stored.size(0) > capacity_ ||
      stored.scalar_type() != at::kFloat || next->second.numel() != 1) {
    throw common::CheckpointError("replay buffer: checkpoint rows are " + c10::str(stored.sizes()) +
                                  ", expected at most " + std::to_string(capacity_) + " rows of " +
                                  std::to_string(row_size()) +
                                  " float32: resume with the configuration and the version it was made with");
  }
  const std::int64_t position = next->second.item<std::int64_t>();
  if (position < 0 || position >= capacity_) {
    throw common::CheckpointError("replay buffer: write position " + std::to_string(position) +
                                  " is outside 0.." + std::to_string(capacity_ - 1));
  }
  inference::check_finite(nets::to_array(stored), "replay buffer: checkpoint rows");
  size_ = stored.size(0);
  next_ = position;
  rows_.narrow(0, 0, size_).copy_(stored);
  if (size_ == capacity_ || next_ == size_) return;
  // A full buffer goes on in a larger one: the oldest row comes first again.
  rows_.narrow(0, 0, size_).copy_(stored.roll(-next_, 0));
  next_ = size_;
}

}  // namespace lodestone::rl
