#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <torch/types.h>

#include "lodestone/common/thread_pool.h"
#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/td3.h"

namespace lodestone::rl {

/// TD3 with every pass written out: no autograd graph, no allocation per update, one pass for Adam and one
/// for Polyak per network.
///
/// Work is cut into two shards whatever the number of threads (the two critics, or two halves of the batch or
/// of the actor's parameters), so that results do not depend on it.
template <class Real>
class FusedTd3 final : public Td3 {
 public:
  FusedTd3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
           std::uint64_t seed, std::int64_t threads);

  nets::NamedTensors networks() const override;

 protected:
  torch::Tensor policy(const torch::Tensor& observation) override;
  UpdateResult learn(const Batch& batch, const torch::Tensor& smoothing_noise, bool policy_too) override;
  nets::NamedTensors optimiser() const override;

 private:
  using Workspace = typename FlatNetwork<Real>::Workspace;
  struct Learner {  // a network, its target, and Adam's moments
    explicit Learner(FlatNetwork<Real> drawn);
    FlatNetwork<Real> network, target;
    torch::Tensor first_moment, second_moment;
    /// Numbers [begin, end) of the parameters.
    void adam(const torch::Tensor& gradient, double learning_rate, std::int64_t step, std::int64_t begin,
              std::int64_t end);
    void polyak(double tau, std::int64_t begin, std::int64_t end);
    std::int64_t size() const { return first_moment.numel(); }
  };
  struct Half {  // scratch of one half of the batch
    std::int64_t start, rows;
    Workspace actor, critic;
    torch::Tensor policy, critic_input, q_gradient, policy_gradient;
  };

  static void share_buffers(const Workspace& critic, Workspace& target, Half& half);
  void prepare_inputs(const Batch& batch, const torch::Tensor& noise, Half& half);
  void differences_from_target(const Batch& batch, UpdateResult& result);
  double update_policy(const Batch& batch);
  void policy_gradient(const Batch& batch, Half& half);

  std::int64_t observation_size_;
  std::int64_t action_size_;
  common::ThreadPool threads_;
  Learner actor_;
  std::array<Learner, 2> critics_;
  // preallocated for one batch
  torch::Tensor critic_input_, next_input_, target_q_;
  std::array<Workspace, 2> critic_work_, target_work_;
  std::array<torch::Tensor, 2> q_gradient_;
  std::vector<Half> halves_;
  Workspace act_work_;
};

extern template class FusedTd3<float>;
extern template class FusedTd3<double>;

}  // namespace lodestone::rl
