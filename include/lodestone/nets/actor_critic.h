#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <torch/nn/modules/linear.h>

namespace lodestone::nets {

/// Actor of section IV-B2: D -> hidden (ReLU) -> 2, tanh.
class ActorImpl : public torch::nn::Module {
 public:
  ActorImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
            std::int64_t action_size = 2);
  /// [N, D] -> [N, 2] in [-1, 1].
  torch::Tensor forward(const torch::Tensor& observation);

 private:
  std::vector<torch::nn::Linear> layers_;  // registered as l1, l2, l3, ... as in the reference implementation
};
TORCH_MODULE(Actor);

/// Twin critic: first critic l1..l3, second critic l4..l6, each (D + 2) -> hidden (ReLU) -> 1.
class TwinCriticImpl : public torch::nn::Module {
 public:
  TwinCriticImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
                 std::int64_t action_size = 2);
  /// [N, D], [N, 2] -> two [N, 1].
  std::pair<torch::Tensor, torch::Tensor> forward(const torch::Tensor& observation,
                                                  const torch::Tensor& action);
  /// First critic alone, [N, 1].
  torch::Tensor first(const torch::Tensor& observation, const torch::Tensor& action);

 private:
  std::vector<torch::nn::Linear> first_;
  std::vector<torch::nn::Linear> second_;
};
TORCH_MODULE(TwinCritic);

}  // namespace lodestone::nets
