#include "td3_autograd.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "rl/td3_samples.h"

using namespace lodestone;
using namespace lodestone::rl;
using rl::tests::identical;
using rl::tests::wave;
using rl::tests::wave_batch;

namespace {

/// Largest difference of two networks' moments or parameters, relative to the largest number of each tensor.
double largest_relative_difference(const nets::NamedTensors& one, const nets::NamedTensors& two) {
  REQUIRE(one.size() == two.size());
  double largest = 0.0;
  for (const auto& [name, tensor] : one) {
    const double size = two.at(name).abs().max().item<double>();
    largest = std::max(largest, (tensor - two.at(name)).abs().max().item<double>() / size);
  }
  return largest;
}

/// The gradients of one update of each backend from the same networks, batch and noise. After the first step
/// Adam's first moments are a tenth of the gradients, so they show the gradients of every parameter.
double gradient_difference(at::ScalarType type) {
  Td3Config config;
  config.batch_size = 100;
  config.policy_frequency = 1;
  std::vector<nets::NamedTensors> moments;
  for (const auto backend : {Td3Backend::kFused, Td3Backend::kAutograd}) {
    config.backend = backend;
    const auto td3 = make_td3(config, 6, 2, 4, 2, type);
    td3->update(wave_batch(100, 1, type), (0.3 * wave(5, {100, 2})).to(type));
    nets::Checkpoint checkpoint;
    td3->save(checkpoint);
    nets::NamedTensors first;
    for (const auto& [name, tensor] : checkpoint.parts.at("optimiser")) {
      if (name.find("first_moment") != std::string::npos) first[name] = tensor;
    }
    moments.push_back(first);
  }
  CHECK(moments.front().size() == 18);
  return largest_relative_difference(moments[0], moments[1]);
}

}  // namespace

TEST_CASE("The fused backend's gradients are those of autograd", "[rl]") {
  // A network that autograd updates first would move the other's: both start from the seed's.
  CHECK(gradient_difference(at::kDouble) < 1e-10);
  CHECK(gradient_difference(at::kFloat) < 1e-5);
}

TEST_CASE("Backends stay together over many updates and take up each other's checkpoints", "[rl]") {
  Td3Config config;
  config.batch_size = 64;
  config.hidden = {32, 24};
  const auto fused = make_td3(config, 6, 2, 9, 2, at::kDouble);
  config.backend = Td3Backend::kAutograd;
  const auto autograd = make_td3(config, 6, 2, 9, 1, at::kDouble);
  CHECK(identical(fused->networks(), autograd->networks()));
  const auto update_both = [&](int update) {
    const Batch batch = wave_batch(64, 4 * update, at::kDouble);
    const at::Tensor noise = 0.3 * wave(update, {64, 2});
    const UpdateResult expected = autograd->update(batch, noise);
    const UpdateResult result = fused->update(batch, noise);
    CHECK(result.critic_loss == Approx(expected.critic_loss).epsilon(1e-9));
    CHECK(result.actor_loss == Approx(expected.actor_loss).epsilon(1e-9));
    CHECK(result.q_mean == Approx(expected.q_mean).epsilon(1e-9));
  };
  for (int update = 0; update < 20; ++update) update_both(update);
  nets::Checkpoint one;
  nets::Checkpoint two;
  fused->save(one);
  autograd->save(two);
  fused->load(two);
  autograd->load(one);
  for (int update = 20; update < 30; ++update) update_both(update);
  CHECK(largest_relative_difference(fused->networks(), autograd->networks()) < 1e-8);
}
