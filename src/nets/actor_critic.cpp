#include "lodestone/nets/actor_critic.h"

#include "lodestone/nets/mlp.h"

namespace lodestone::nets {
namespace {

std::vector<std::int64_t> layer_sizes(std::int64_t inputs, const std::vector<std::int64_t>& hidden,
                                      std::int64_t outputs) {
  std::vector<std::int64_t> sizes = {inputs};
  sizes.insert(sizes.end(), hidden.begin(), hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

}  // namespace

ActorImpl::ActorImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
                     std::int64_t action_size)
    : layers_(register_linear_layers(*this, layer_sizes(observation_size, hidden, action_size))) {}

torch::Tensor ActorImpl::forward(const torch::Tensor& observation) {
  return torch::tanh(forward_relu(layers_, observation));
}

TwinCriticImpl::TwinCriticImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
                               std::int64_t action_size) {
  const std::vector<std::int64_t> sizes = layer_sizes(observation_size + action_size, hidden, 1);
  first_ = register_linear_layers(*this, sizes, 1);
  second_ = register_linear_layers(*this, sizes, static_cast<int>(sizes.size()));
}

std::pair<torch::Tensor, torch::Tensor> TwinCriticImpl::forward(const torch::Tensor& observation,
                                                                const torch::Tensor& action) {
  const torch::Tensor input = torch::cat({observation, action}, 1);
  return {forward_relu(first_, input), forward_relu(second_, input)};
}

torch::Tensor TwinCriticImpl::first(const torch::Tensor& observation, const torch::Tensor& action) {
  return forward_relu(first_, torch::cat({observation, action}, 1));
}

}  // namespace lodestone::nets
