// The learner of train_ppo.cpp: proximal policy optimisation (Schulman et al., 2017), in LibTorch alone.
#pragma once

#include <torch/torch.h>

#include <vector>

class Ppo {
 public:
  static constexpr std::int64_t kHidden = 64;

  explicit Ppo(std::int64_t observation_size)
      : actor(network(observation_size, 2)), critic(network(observation_size, 1)) {
    for (const auto& part : {actor->parameters(), critic->parameters(), {log_sigma_}})
      optimiser_.add_param_group(part);
  }

  at::Tensor explore(const at::Tensor& seen) {
    const at::Tensor mean = actor->forward(seen).tanh();
    return mean + log_sigma_.exp() * torch::randn_like(mean);
  }
  /// Of actions [N, 2] at observations [N, D]: the logarithm [N, 1] of their density, but for a constant.
  at::Tensor log_chance(const at::Tensor& seen, const at::Tensor& action) {
    const at::Tensor off = (action - actor->forward(seen).tanh()) / log_sigma_.exp();
    return -off.square().sum(1, true) / 2 - log_sigma_.sum();
  }

  /// Several passes over the rows, in minibatches: the clipped objective, and what the critic shall expect.
  void improve(const at::Tensor& seen, const at::Tensor& action, const at::Tensor& value,
               const at::Tensor& advantage) {
    const at::Tensor target = value + advantage;
    const at::Tensor before = log_chance(seen, action).detach();
    for (int epoch = 0; epoch < 4; ++epoch) {
      for (const at::Tensor& rows : torch::randperm(seen.size(0)).chunk(8)) {
        const auto of_rows = [&rows](const at::Tensor& column) { return column.index_select(0, rows); };
        const at::Tensor ratio = (log_chance(of_rows(seen), of_rows(action)) - of_rows(before)).exp();
        const at::Tensor batch = of_rows(advantage), gain = (batch - batch.mean()) / batch.std();
        const at::Tensor objective = torch::min(ratio * gain, ratio.clamp(0.8, 1.2) * gain).mean();
        const at::Tensor error = (critic->forward(of_rows(seen)) - of_rows(target)).square().mean() / 2;
        optimiser_.zero_grad();
        (error - objective).backward();
        optimiser_.step();
      }
    }
  }

  torch::nn::Sequential actor, critic;  ///< a tanh comes after the actor

 private:
  static torch::nn::Sequential network(std::int64_t inputs, std::int64_t outputs) {
    using namespace torch::nn;
    const Linear l1(inputs, kHidden), l2(kHidden, kHidden), l3(kHidden, outputs);
    return Sequential({{"l1", l1}, {"relu1", ReLU()}, {"l2", l2}, {"relu2", ReLU()}, {"l3", l3}});
  }

  at::Tensor log_sigma_ = torch::full({2}, -0.7, torch::requires_grad());
  torch::optim::Adam optimiser_{std::vector<at::Tensor>{}, 1e-3};
};
