#include "td3_networks.h"

#include <catch2/catch.hpp>

#include "rl/td3_samples.h"

using namespace lodestone::rl;

namespace {

Td3Config small_networks() {
  Td3Config config;
  config.hidden = {4, 3};
  return config;
}

}  // namespace

TEST_CASE("Networks and moments are views by the reference implementation's names", "[rl]") {
  Td3Networks<float> drawn(small_networks(), 5, 2, 1);
  auto networks = drawn.networks();
  CHECK(networks.size() == 2 * (6 + 12));
  CHECK(networks.at("actor.l1.weight").sizes() == at::IntArrayRef({4, 5}));
  CHECK(networks.at("critic.l4.weight").sizes() == at::IntArrayRef({4, 7}));
  CHECK(networks.at("critic_target.l6.bias").sizes() == at::IntArrayRef({1}));
  networks.at("critic.l4.weight").fill_(2.0);
  CHECK(drawn.critics[1].network.parameters().max().item<float>() == 2.0F);
  const auto moments = drawn.optimiser();
  CHECK(moments.size() == 2 * (6 + 12));
  CHECK(moments.at("critic.second_moment.l6.weight").abs().max().item<float>() == 0.0F);
}

TEST_CASE("Networks are drawn apart, the same for every type, and targets begin equal", "[rl]") {
  const auto wide = Td3Networks<double>(small_networks(), 5, 2, 1).networks();
  const auto narrow = Td3Networks<float>(small_networks(), 5, 2, 1).networks();
  CHECK(at::equal(wide.at("critic.l4.weight"), wide.at("critic_target.l4.weight")));
  CHECK_FALSE(at::equal(wide.at("critic.l1.weight"), wide.at("critic.l4.weight")));
  CHECK(at::equal(wide.at("actor.l1.weight").to(at::kFloat), narrow.at("actor.l1.weight")));
}

TEST_CASE("A learner's steps move the numbers they are asked to", "[rl]") {
  Td3Networks<double> drawn(small_networks(), 5, 2, 1);
  Learner<double>& actor = drawn.actor;
  const at::Tensor before = actor.network.parameters().clone();
  actor.adam(at::ones_like(before), 1e-2, 1, 2, 5);
  const at::Tensor moved = before - actor.network.parameters();
  CHECK(moved.narrow(0, 0, 2).abs().max().item<double>() == 0.0);
  CHECK(at::allclose(moved.narrow(0, 2, 3), at::full({3}, 1e-2, at::kDouble), 0, 1e-8));
  CHECK(moved.narrow(0, 5, moved.numel() - 5).abs().max().item<double>() == 0.0);
  actor.polyak(0.5, 0, 3);
  CHECK((before - actor.target.parameters())[2].item<double>() == Approx(0.5e-2).epsilon(1e-6));
  CHECK((before - actor.target.parameters())[3].item<double>() == 0.0);
}
