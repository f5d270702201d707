#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lodestone/common/thread_pool.h"
#include "lodestone/rl/td3.h"
#include "td3_networks.h"

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

  nets::NamedTensors networks() const override { return networks_.networks(); }

 protected:
  at::Tensor policy(const at::Tensor& observation) override;
  UpdateResult learn(const Batch& batch, const at::Tensor& smoothing_noise, bool policy_too) override;
  nets::NamedTensors optimiser() const override { return networks_.optimiser(); }

 private:
  using Workspace = typename FlatNetwork<Real>::Workspace;
  struct Half {  // scratch of one half of the batch
    std::int64_t start, rows;
    Workspace actor, critic;
    at::Tensor policy, critic_input, q_gradient, policy_gradient;
  };

  static void share_buffers(const Workspace& critic, Workspace& target, Half& half);
  void prepare_inputs(const Batch& batch, const at::Tensor& noise, Half& half);
  void differences_from_target(const Batch& batch, UpdateResult& result);
  double update_policy(const Batch& batch);
  void policy_gradient(const Batch& batch, Half& half);

  std::int64_t observation_size_;
  std::int64_t action_size_;
  common::ThreadPool threads_;
  Td3Networks<Real> networks_;
  // preallocated for one batch
  at::Tensor critic_input_, next_input_, target_q_;
  std::array<Workspace, 2> critic_work_, target_work_;
  std::array<at::Tensor, 2> q_gradient_;
  std::vector<Half> halves_;
  Workspace act_work_;
};

extern template class FusedTd3<float>;
extern template class FusedTd3<double>;

}  // namespace lodestone::rl
