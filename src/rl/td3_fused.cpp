#include "td3_fused.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include <ATen/ops/empty_like.h>
#include <ATen/ops/full.h>
#include <ATen/ops/zeros.h>

namespace lodestone::rl {
namespace {

constexpr std::size_t kShards = 2;

/// out [rows, D + A]: each row of `left` [rows, D], then that of `right` [rows, A].
template <class Real>
void join(const Real* left, std::int64_t left_columns, const Real* right, std::int64_t right_columns,
          std::int64_t rows, Real* out) {
  for (std::int64_t row = 0; row < rows; ++row) {
    out = std::copy_n(left + row * left_columns, left_columns, out);
    out = std::copy_n(right + row * right_columns, right_columns, out);
  }
}

}  // namespace

template <class Real>
FusedTd3<Real>::FusedTd3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
                         std::uint64_t seed, std::int64_t threads)
    : Td3(config, observation_size, action_size, seed, c10::CppTypeToScalarType<Real>::value),
      observation_size_(observation_size),
      action_size_(action_size),
      threads_(static_cast<std::size_t>(std::clamp<std::int64_t>(threads, 1, kShards))),
      networks_(config, observation_size, action_size, seed) {
  const auto type = c10::CppTypeToScalarType<Real>::value;
  const std::int64_t rows = config.batch_size;
  const std::int64_t columns = observation_size + action_size;
  critic_input_ = at::zeros({rows, columns}, type);
  next_input_ = at::zeros({rows, columns}, type);
  target_q_ = at::zeros({rows}, type);
  const std::int64_t middle = rows / 2;
  for (std::size_t k = 0; k < kShards; ++k) {
    critic_work_[k] =
        networks_.critics[k].network.workspace(rows + rows % 2);  // room for two halves, see share_buffers()
    critic_work_[k].rows = rows;
    target_work_[k] = networks_.critics[k].target.workspace(rows);
    q_gradient_[k] = at::zeros({rows}, type);
    const std::int64_t start = k == 0 ? 0 : middle;
    const std::int64_t count = k == 0 ? middle : rows - middle;
    halves_.push_back({start, count, networks_.actor.network.workspace(count),
                       networks_.critics[0].network.workspace(count), at::zeros({count, action_size}, type),
                       at::zeros({count, columns}, type),
                       at::full({count}, -1.0 / static_cast<double>(rows), type),
                       at::zeros({count, action_size}, type)});
    share_buffers(critic_work_[k], target_work_[k], halves_[k]);
  }
}

/// A shard's passes follow one another, so that they can use the same memory, which then stays in the core's
/// cache: only the critic's hidden outputs are needed from one pass to the next, and no gradient before its
/// backward pass.
template <class Real>
void FusedTd3<Real>::share_buffers(const Workspace& critic, Workspace& target, Half& half) {
  target.hidden = critic.delta;
  target.scratch = half.actor.scratch = half.critic.scratch = critic.scratch;
  for (std::size_t i = 0; i < critic.hidden.size(); ++i) {
    const std::int64_t middle = critic.hidden[i].size(0) / 2;
    half.actor.hidden[i] = critic.hidden[i].narrow(0, 0, half.rows);
    half.actor.delta[i] = critic.delta[i].narrow(0, 0, half.rows);
    half.critic.hidden[i] = critic.hidden[i].narrow(0, middle, half.rows);
    half.critic.delta[i] = critic.delta[i].narrow(0, middle, half.rows);
  }
}

template <class Real>
at::Tensor FusedTd3<Real>::policy(const at::Tensor& observation) {
  if (act_work_.rows != observation.size(0))
    act_work_ = networks_.actor.network.workspace(observation.size(0));
  networks_.actor.network.forward(observation.template data_ptr<Real>(), act_work_);
  at::Tensor action = at::empty_like(act_work_.output);
  const Real* output = act_work_.output.template data_ptr<Real>();
  // As inference::Actor, and not by LibTorch's own tanh, whose last bit depends on the processor.
  std::transform(output, output + action.numel(), action.template data_ptr<Real>(),
                 [](Real x) { return std::tanh(x); });
  return action;
}

/// The critics' inputs of one half: (s, a), and (s', a') with the target policy's smoothed action.
template <class Real>
void FusedTd3<Real>::prepare_inputs(const Batch& batch, const at::Tensor& noise, Half& half) {
  const std::int64_t columns = observation_size_ + action_size_;
  const Real* next = batch.next_observation.template data_ptr<Real>() + half.start * observation_size_;
  networks_.actor.target.forward(next, half.actor);
  const auto clip = static_cast<Real>(config().noise_clip);
  const Real* output = half.actor.output.template data_ptr<Real>();
  const Real* disturbed = noise.template data_ptr<Real>() + half.start * action_size_;
  Real* action = half.policy.template data_ptr<Real>();
  for (std::int64_t i = 0; i < half.rows * action_size_; ++i) {
    action[i] = std::clamp(std::tanh(output[i]) + std::clamp(disturbed[i], -clip, clip), Real(-1), Real(1));
  }
  join(next, observation_size_, action, action_size_, half.rows,
       next_input_.template data_ptr<Real>() + half.start * columns);
  join(batch.observation.template data_ptr<Real>() + half.start * observation_size_, observation_size_,
       batch.action.template data_ptr<Real>() + half.start * action_size_, action_size_, half.rows,
       critic_input_.template data_ptr<Real>() + half.start * columns);
}

/// target = r + discount * min(Q1', Q2') unless the episode ended; the gradient of the mean squared
/// difference.
template <class Real>
void FusedTd3<Real>::differences_from_target(const Batch& batch, UpdateResult& result) {
  const auto rows = static_cast<double>(target_q_.numel());
  const auto discount = static_cast<Real>(config().discount);
  const auto scale = static_cast<Real>(2.0 / rows);
  const Real* reward = batch.reward.template data_ptr<Real>();
  const Real* not_done = batch.not_done.template data_ptr<Real>();
  Real* target = target_q_.template data_ptr<Real>();
  const Real* next_first = target_work_[0].output.template data_ptr<Real>();
  const Real* next_second = target_work_[1].output.template data_ptr<Real>();
  for (std::int64_t i = 0; i < target_q_.numel(); ++i) {
    target[i] = reward[i] + discount * not_done[i] * std::min(next_first[i], next_second[i]);
  }
  std::array<double, 2> squares{};
  for (std::size_t k = 0; k < networks_.critics.size(); ++k) {
    const Real* q = critic_work_[k].output.template data_ptr<Real>();
    Real* gradient = q_gradient_[k].template data_ptr<Real>();
    for (std::int64_t i = 0; i < target_q_.numel(); ++i) {
      const Real difference = q[i] - target[i];
      squares[k] += static_cast<double>(difference) * static_cast<double>(difference);
      gradient[i] = scale * difference;
    }
  }
  const Real* q = critic_work_[0].output.template data_ptr<Real>();
  const double q_sum = std::accumulate(q, q + target_q_.numel(), 0.0);
  result.critic_loss = (squares[0] + squares[1]) / rows;
  result.q_mean = q_sum / rows;
  result.target_q = target_q_;
}

template <class Real>
UpdateResult FusedTd3<Real>::learn(const Batch& batch, const at::Tensor& smoothing_noise, bool policy_too) {
  UpdateResult result;
  result.policy_updated = policy_too;
  threads_.for_each(kShards,
                    [&](std::size_t shard) { prepare_inputs(batch, smoothing_noise, halves_[shard]); });
  threads_.for_each(kShards, [&](std::size_t k) {
    networks_.critics[k].target.forward(next_input_.template data_ptr<Real>(), target_work_[k]);
    networks_.critics[k].network.forward(critic_input_.template data_ptr<Real>(), critic_work_[k]);
  });
  differences_from_target(batch, result);
  threads_.for_each(kShards, [&](std::size_t k) {
    Learner<Real>& critic = networks_.critics[k];
    critic.network.backward(critic_input_.template data_ptr<Real>(), q_gradient_[k].template data_ptr<Real>(),
                            critic_work_[k], FlatNetwork<Real>::Wanted::kParameters);
    critic.adam(critic_work_[k].gradient, learning_rate(), critic_steps(), 0, critic.size());
    // the policy's update reads no target
    if (policy_too) critic.polyak(config().polyak_tau, 0, critic.size());
  });
  if (policy_too) result.actor_loss = update_policy(batch);
  return result;
}

template <class Real>
void FusedTd3<Real>::policy_gradient(const Batch& batch, Half& half) {
  const Real* observation = batch.observation.template data_ptr<Real>() + half.start * observation_size_;
  networks_.actor.network.forward(observation, half.actor);
  const Real* output = half.actor.output.template data_ptr<Real>();
  Real* action = half.policy.template data_ptr<Real>();
  for (std::int64_t i = 0; i < half.rows * action_size_; ++i) action[i] = std::tanh(output[i]);
  Real* input = half.critic_input.template data_ptr<Real>();
  join(observation, observation_size_, action, action_size_, half.rows, input);
  const FlatNetwork<Real>& critic = networks_.critics[0].network;
  critic.forward(input, half.critic);
  critic.backward(input, half.q_gradient.template data_ptr<Real>(), half.critic,
                  FlatNetwork<Real>::Wanted::kInput);
  const Real* passed_on = half.critic.input_gradient.template data_ptr<Real>();
  Real* gradient = half.policy_gradient.template data_ptr<Real>();
  for (std::int64_t row = 0; row < half.rows; ++row) {
    for (std::int64_t j = 0; j < action_size_; ++j) {
      const Real a = action[row * action_size_ + j];
      gradient[row * action_size_ + j] =
          passed_on[row * (observation_size_ + action_size_) + observation_size_ + j] * (Real(1) - a * a);
    }
  }
  networks_.actor.network.backward(observation, gradient, half.actor, FlatNetwork<Real>::Wanted::kParameters);
}

template <class Real>
double FusedTd3<Real>::update_policy(const Batch& batch) {
  threads_.for_each(kShards, [&](std::size_t shard) { policy_gradient(batch, halves_[shard]); });
  double q_sum = 0.0;
  for (const Half& half : halves_) {
    const Real* q = half.critic.output.template data_ptr<Real>();
    q_sum = std::accumulate(q, q + half.rows, q_sum);
  }
  const std::int64_t middle = networks_.actor.size() / 2;
  threads_.for_each(kShards, [&](std::size_t shard) {
    const std::int64_t begin = shard == 0 ? 0 : middle;
    const std::int64_t end = shard == 0 ? middle : networks_.actor.size();
    Real* __restrict gradient = halves_[0].actor.gradient.template data_ptr<Real>();
    const Real* __restrict other = halves_[1].actor.gradient.template data_ptr<Real>();
    for (std::int64_t i = begin; i < end; ++i) gradient[i] += other[i];
    networks_.actor.adam(halves_[0].actor.gradient, learning_rate(), actor_steps(), begin, end);
    networks_.actor.polyak(config().polyak_tau, begin, end);
  });
  return -q_sum / static_cast<double>(target_q_.numel());
}

template class FusedTd3<float>;
template class FusedTd3<double>;

}  // namespace lodestone::rl
