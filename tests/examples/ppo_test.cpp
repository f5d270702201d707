#include "ppo.h"

#include <catch2/catch.hpp>
#include <cmath>

TEST_CASE(
    "the example's learner goes where the advantage is, and no further than the clipped objective lets it") {
  torch::manual_seed(1);
  torch::set_num_threads(1);
  Ppo ppo(4);
  const at::Tensor seen = torch::randn({2048, 4});
  const auto forward = [&](torch::nn::Sequential& network) {
    const torch::NoGradGuard no_grad;
    return network->forward(seen);
  };
  const auto log_chance = [&](const at::Tensor& action) { return ppo.log_chance(seen, action).detach(); };
  const at::Tensor mean = forward(ppo.actor).tanh(), action = ppo.explore(seen).detach();
  const at::Tensor before = log_chance(action);
  // A larger first component is better than was expected, a smaller one worse.
  const at::Tensor advantage = (action - mean).narrow(1, 0, 1).sign();
  const at::Tensor value = torch::full_like(advantage, 2.0);
  const auto error = [&] { return (forward(ppo.critic) - value - advantage).square().mean().item<double>(); };
  const double error_before = error();

  ppo.improve(seen, action, value, advantage);
  const at::Tensor moved = (forward(ppo.actor).tanh() - mean).mean(0);
  const at::Tensor ratio = (log_chance(action) - before).exp();
  CHECK(moved[0].item<double>() > 0.05);
  CHECK(std::abs(moved[1].item<double>()) < 0.05);
  CHECK(moved[0].item<double>() < 0.5);     // 0.26; without the clip 0.84
  CHECK(ratio.std().item<double>() < 1.5);  // 0.6; without it 3.9
  CHECK(error() < 0.5 * error_before);
}
