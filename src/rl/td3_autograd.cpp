#include "td3_autograd.h"

#include <string>

#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/linear.h>
#include <ATen/ops/min.h>
#include <ATen/ops/mse_loss.h>
#include <ATen/ops/zeros_like.h>

namespace lodestone::rl {

template <class Real>
AutogradTd3<Real>::Module::Module(const FlatNetwork<Real>& network)
    : gradient(at::zeros_like(network.parameters())) {
  const nets::NamedTensors views = network.named(network.parameters(), "");
  const nets::NamedTensors gradients = network.named(gradient, "");
  const auto leaf = [&](const std::string& name) {
    at::Tensor tensor = views.at(name).detach().set_requires_grad(true);
    tensor.mutable_grad() = gradients.at(name);
    return tensor;
  };
  for (std::size_t i = 1; 2 * i <= views.size(); ++i) {
    const std::string layer = "l" + std::to_string(i);
    layers.emplace_back(leaf(layer + ".weight"), leaf(layer + ".bias"));
  }
}

template <class Real>
at::Tensor AutogradTd3<Real>::Module::operator()(at::Tensor x) const {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    x = at::linear(x, layers[i].first, layers[i].second);
    if (i + 1 < layers.size()) x = x.relu();
  }
  return x;
}

template <class Real>
AutogradTd3<Real>::AutogradTd3(const Td3Config& config, std::int64_t observation_size,
                               std::int64_t action_size, std::uint64_t seed)
    : Td3(config, observation_size, action_size, seed, c10::CppTypeToScalarType<Real>::value),
      networks_(config, observation_size, action_size, seed),
      actor_(networks_.actor.network),
      actor_target_(networks_.actor.target),
      critics_{Module(networks_.critics[0].network), Module(networks_.critics[1].network)},
      critic_targets_{Module(networks_.critics[0].target), Module(networks_.critics[1].target)} {}

template <class Real>
at::Tensor AutogradTd3<Real>::policy(const at::Tensor& observation) {
  return actor_(observation).tanh();
}

template <class Real>
UpdateResult AutogradTd3<Real>::learn(const Batch& batch, const at::Tensor& smoothing_noise,
                                      bool policy_too) {
  const at::AutoGradMode with_gradients(true);
  UpdateResult result;
  {
    const at::NoGradGuard no_grad;
    const at::Tensor noise = smoothing_noise.clamp(-config().noise_clip, config().noise_clip);
    const at::Tensor next_action = (actor_target_(batch.next_observation).tanh() + noise).clamp(-1.0, 1.0);
    const at::Tensor input = at::cat({batch.next_observation, next_action}, 1);
    const at::Tensor q = at::min(critic_targets_[0](input), critic_targets_[1](input)).squeeze(1);
    result.target_q = batch.reward + config().discount * batch.not_done * q;
  }
  const at::Tensor input = at::cat({batch.observation, batch.action}, 1);
  const at::Tensor q1 = critics_[0](input).squeeze(1);
  const at::Tensor q2 = critics_[1](input).squeeze(1);
  const at::Tensor critic_loss = at::mse_loss(q1, result.target_q) + at::mse_loss(q2, result.target_q);
  for (Module& critic : critics_) critic.gradient.zero_();
  critic_loss.backward();
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    Learner<Real>& critic = networks_.critics[k];
    critic.adam(critics_[k].gradient, learning_rate(), critic_steps(), 0, critic.size());
  }
  result.critic_loss = critic_loss.item<double>();
  result.q_mean = q1.mean().item<double>();
  if (!policy_too) return result;

  const at::Tensor action = actor_(batch.observation).tanh();
  const at::Tensor actor_loss = -critics_[0](at::cat({batch.observation, action}, 1)).mean();
  actor_.gradient.zero_();
  actor_loss.backward();
  Learner<Real>& actor = networks_.actor;
  actor.adam(actor_.gradient, learning_rate(), actor_steps(), 0, actor.size());
  actor.polyak(config().polyak_tau, 0, actor.size());
  for (Learner<Real>& critic : networks_.critics) critic.polyak(config().polyak_tau, 0, critic.size());
  result.policy_updated = true;
  result.actor_loss = actor_loss.item<double>();
  return result;
}

template class AutogradTd3<float>;
template class AutogradTd3<double>;

}  // namespace lodestone::rl
