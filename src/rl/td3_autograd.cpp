#include "td3_autograd.h"

#include <sstream>
#include <string>
#include <type_traits>

#include "lodestone/common/error.h"
#include "td3_networks.h"

namespace lodestone::rl {
namespace {

void insert_named(nets::NamedTensors& all, const torch::nn::Module& module, const std::string& prefix) {
  for (const auto& item : module.named_parameters()) all[prefix + item.key()] = item.value();
}

/// What an optimiser files the state of a parameter under: LibTorch 1 its address as text, LibTorch 2 the
/// address.
template <class Key>
Key key_of(const torch::Tensor& parameter) {
  if constexpr (std::is_same_v<Key, std::string>) {
    std::ostringstream text;
    text << parameter.unsafeGetTensorImpl();
    return text.str();
  } else {
    return parameter.unsafeGetTensorImpl();
  }
}

template <class States>
torch::optim::AdamParamState& state_of(States& states, const torch::Tensor& parameter) {
  auto& state = states[key_of<typename States::key_type>(parameter)];
  if (!state) {  // as Adam makes it at its first step, so that moments can be saved and loaded at any time
    auto fresh = std::make_unique<torch::optim::AdamParamState>();
    fresh->step(0);
    fresh->exp_avg(torch::zeros_like(parameter, torch::MemoryFormat::Preserve).detach());
    fresh->exp_avg_sq(torch::zeros_like(parameter, torch::MemoryFormat::Preserve).detach());
    state = std::move(fresh);
  }
  return static_cast<torch::optim::AdamParamState&>(*state);
}

void insert_moments(nets::NamedTensors& all, torch::optim::Adam& adam, const torch::nn::Module& module,
                    const std::string& prefix) {
  for (const auto& item : module.named_parameters()) {
    torch::optim::AdamParamState& state = state_of(adam.state(), item.value());
    all[prefix + "first_moment." + item.key()] = state.exp_avg();
    all[prefix + "second_moment." + item.key()] = state.exp_avg_sq();
  }
}

void set_steps(torch::optim::Adam& adam, const torch::nn::Module& module, std::int64_t steps) {
  for (const torch::Tensor& parameter : module.parameters()) state_of(adam.state(), parameter).step(steps);
}

void step(torch::optim::Adam& adam, const torch::Tensor& loss, double learning_rate) {
  static_cast<torch::optim::AdamOptions&>(adam.param_groups()[0].options()).lr(learning_rate);
  adam.zero_grad();
  loss.backward();
  adam.step();
}

/// target <- tau * network + (1 - tau) * target
void polyak(torch::nn::Module& target, const torch::nn::Module& network, double tau) {
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> targets = target.parameters();
  const std::vector<torch::Tensor> sources = network.parameters();
  for (std::size_t i = 0; i < targets.size(); ++i) targets[i].mul_(1.0 - tau).add_(sources[i], tau);
}

template <class Real>
nets::NamedTensors drawn_tensors(const Td3Config& config, std::int64_t observation_size,
                                 std::int64_t action_size, std::uint64_t seed) {
  const Td3Networks<Real> drawn(config, observation_size, action_size, seed);
  nets::NamedTensors tensors = drawn.actor.named(drawn.actor.parameters(), "actor.");
  const int layers = static_cast<int>(config.hidden.size()) + 1;
  for (int k = 0; k < 2; ++k) {
    const FlatNetwork<Real>& critic = drawn.critics[static_cast<std::size_t>(k)];
    const nets::NamedTensors views = critic.named(critic.parameters(), "critic.", 1 + k * layers);
    tensors.insert(views.begin(), views.end());
  }
  return tensors;
}

}  // namespace

AutogradTd3::AutogradTd3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
                         std::uint64_t seed, torch::ScalarType type)
    : Td3(config, observation_size, action_size, seed, type),
      actor_(observation_size, config.hidden, action_size),
      actor_target_(observation_size, config.hidden, action_size),
      critic_(observation_size, config.hidden, action_size),
      critic_target_(observation_size, config.hidden, action_size) {
  const torch::NoGradGuard no_grad;
  for (torch::nn::Module* module :
       {static_cast<torch::nn::Module*>(actor_.get()), static_cast<torch::nn::Module*>(actor_target_.get()),
        static_cast<torch::nn::Module*>(critic_.get()),
        static_cast<torch::nn::Module*>(critic_target_.get())}) {
    module->to(type);
  }
  const nets::NamedTensors drawn = type == torch::kFloat64
                                       ? drawn_tensors<double>(config, observation_size, action_size, seed)
                                       : drawn_tensors<float>(config, observation_size, action_size, seed);
  for (auto& [name, tensor] : networks()) {
    const std::size_t target = name.find("_target.");
    const std::string source =
        target == std::string::npos ? name : name.substr(0, target) + name.substr(target + 7);
    torch::Tensor parameter = tensor;
    parameter.copy_(drawn.at(source));
  }
  const torch::optim::AdamOptions options(config.learning_rate);
  actor_optimiser_ = std::make_unique<torch::optim::Adam>(actor_->parameters(), options);
  critic_optimiser_ = std::make_unique<torch::optim::Adam>(critic_->parameters(), options);
}

torch::Tensor AutogradTd3::policy(const torch::Tensor& observation) { return actor_->forward(observation); }

UpdateResult AutogradTd3::learn(const Batch& batch, const torch::Tensor& smoothing_noise, bool policy_too) {
  const torch::AutoGradMode with_gradients(true);
  UpdateResult result;
  {
    const torch::NoGradGuard no_grad;
    const torch::Tensor noise = smoothing_noise.clamp(-config().noise_clip, config().noise_clip);
    const torch::Tensor next_action =
        (actor_target_->forward(batch.next_observation) + noise).clamp(-1.0, 1.0);
    const auto [q1, q2] = critic_target_->forward(batch.next_observation, next_action);
    result.target_q = batch.reward + config().discount * batch.not_done * torch::min(q1, q2).squeeze(1);
  }
  const auto [q1, q2] = critic_->forward(batch.observation, batch.action);
  const torch::Tensor critic_loss =
      torch::mse_loss(q1.squeeze(1), result.target_q) + torch::mse_loss(q2.squeeze(1), result.target_q);
  step(*critic_optimiser_, critic_loss, learning_rate());
  result.critic_loss = critic_loss.item<double>();
  result.q_mean = q1.mean().item<double>();
  if (!policy_too) return result;

  const torch::Tensor actor_loss =
      -critic_->first(batch.observation, actor_->forward(batch.observation)).mean();
  step(*actor_optimiser_, actor_loss, learning_rate());
  polyak(*critic_target_, *critic_, config().polyak_tau);
  polyak(*actor_target_, *actor_, config().polyak_tau);
  result.policy_updated = true;
  result.actor_loss = actor_loss.item<double>();
  return result;
}

nets::NamedTensors AutogradTd3::networks() const {
  nets::NamedTensors all;
  insert_named(all, *actor_, "actor.");
  insert_named(all, *actor_target_, "actor_target.");
  insert_named(all, *critic_, "critic.");
  insert_named(all, *critic_target_, "critic_target.");
  return all;
}

nets::NamedTensors AutogradTd3::optimiser() const {
  nets::NamedTensors all;
  insert_moments(all, *actor_optimiser_, *actor_, "actor.");
  insert_moments(all, *critic_optimiser_, *critic_, "critic.");
  return all;
}

void AutogradTd3::counters_loaded() {
  set_steps(*actor_optimiser_, *actor_, actor_steps());
  set_steps(*critic_optimiser_, *critic_, critic_steps());
}

}  // namespace lodestone::rl
