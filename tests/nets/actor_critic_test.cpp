#include "lodestone/nets/actor_critic.h"

#include <catch2/catch.hpp>

#include <torch/torch.h>

#include "lodestone/inference/actor_critic.h"
#include "lodestone/nets/checkpoint.h"

namespace lodestone::nets {
namespace {

TEST_CASE("actor and critic have the paper's shapes", "[unit]") {
  Actor actor(5, std::vector<std::int64_t>{256, 256});
  TwinCritic critic(5, std::vector<std::int64_t>{256, 256});
  const NamedTensors a = module_tensors(*actor);
  const NamedTensors c = module_tensors(*critic);
  CHECK(a.at("l1.weight").sizes() == torch::IntArrayRef({256, 5}));
  CHECK(a.at("l3.weight").sizes() == torch::IntArrayRef({2, 256}));
  CHECK(c.at("l1.weight").sizes() == torch::IntArrayRef({256, 7}));
  CHECK(c.at("l4.weight").sizes() == torch::IntArrayRef({256, 7}));
  CHECK(c.at("l6.weight").sizes() == torch::IntArrayRef({1, 256}));
  const torch::Tensor observation = torch::randn({9, 5});
  const torch::Tensor action = actor->forward(10.0 * observation);
  CHECK(action.abs().max().item<double>() <= 1.0);
  const auto [q1, q2] = critic->forward(observation, action);
  CHECK(torch::equal(q1, critic->first(observation, action)));
  CHECK_FALSE(torch::equal(q1, q2));
}

TEST_CASE("the plain actor and critics say what the modules say", "[unit]") {
  const torch::NoGradGuard no_grad;
  Actor actor(5, std::vector<std::int64_t>{64, 32});
  TwinCritic critic(5, std::vector<std::int64_t>{64, 32});
  const torch::Tensor observation = torch::randn({33, 5});
  torch::Tensor action = torch::empty({33, 2});
  const inference::Actor plain(to_arrays(module_tensors(*actor)), 5, {64, 32});
  inference::Actor::Workspace workspace;
  plain.act(observation.data_ptr<float>(), 33, action.data_ptr<float>(), workspace);
  CHECK(torch::allclose(action, actor->forward(observation), 0.0, 1e-6));
  torch::Tensor q = torch::empty({2, 33});
  inference::TwinCritic(to_arrays(module_tensors(*critic)), 5, {64, 32})
      .evaluate(observation.data_ptr<float>(), action.data_ptr<float>(), 33, q.data_ptr<float>(),
                q.data_ptr<float>() + 33, workspace);
  const auto [first, second] = critic->forward(observation, action);
  CHECK(torch::allclose(q[0], first.squeeze(1), 0.0, 1e-6));
  CHECK(torch::allclose(q[1], second.squeeze(1), 0.0, 1e-6));
}

}  // namespace
}  // namespace lodestone::nets
