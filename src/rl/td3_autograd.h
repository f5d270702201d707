#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lodestone/rl/td3.h"
#include "td3_networks.h"

namespace lodestone::rl {

/// TD3 in plain LibTorch: its layers and its autograd. Slower than FusedTd3 and written to be read; the two
/// start from the same networks and are compared by a test.
template <class Real>
class AutogradTd3 final : public Td3 {
 public:
  AutogradTd3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
              std::uint64_t seed);

  nets::NamedTensors networks() const override { return networks_.networks(); }

 protected:
  at::Tensor policy(const at::Tensor& observation) override;
  UpdateResult learn(const Batch& batch, const at::Tensor& smoothing_noise, bool policy_too) override;
  nets::NamedTensors optimiser() const override { return networks_.optimiser(); }

 private:
  /// A flat network as autograd sees it: weights and biases that are views of its numbers.
  struct Module {
    explicit Module(const FlatNetwork<Real>& network);
    /// ReLU after every layer but the last. [B, in] -> [B, out].
    at::Tensor operator()(at::Tensor x) const;

    at::Tensor gradient;  ///< laid out like the parameters, filled by backward()
    std::vector<std::pair<at::Tensor, at::Tensor>> layers;
  };

  Td3Networks<Real> networks_;
  Module actor_, actor_target_;
  std::array<Module, 2> critics_, critic_targets_;
};

extern template class AutogradTd3<float>;
extern template class AutogradTd3<double>;

}  // namespace lodestone::rl
