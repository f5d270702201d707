#include "td3_fused.h"

#include <catch2/catch.hpp>

#include "rl/td3_samples.h"

using namespace lodestone::rl;
using lodestone::rl::tests::identical;
using lodestone::rl::tests::random_buffer;

TEST_CASE("Updates do not depend on the number of threads", "[rl]") {
  Td3Config config;
  config.batch_size = 64;
  const ReplayBuffer buffer = random_buffer(500, 6);
  const auto one = make_td3(config, 6, 2, 9, 1);
  const auto two = make_td3(config, 6, 2, 9, 2);
  const auto four = make_td3(config, 6, 2, 9, 4);
  for (int i = 0; i < 20; ++i) {
    const UpdateResult result = one->update(buffer);
    CHECK(two->update(buffer).critic_loss == result.critic_loss);
    CHECK(four->update(buffer).actor_loss == result.actor_loss);
  }
  CHECK(identical(one->networks(), two->networks()));
  CHECK(identical(one->networks(), four->networks()));
}

TEST_CASE("A batch of an odd number of rows is cut into halves that belong together", "[rl]") {
  Td3Config config;
  config.batch_size = 33;
  config.hidden = {16, 8};
  const ReplayBuffer buffer = random_buffer(100, 6);
  FusedTd3<float> one(config, 6, 2, 9, 1);
  FusedTd3<float> two(config, 6, 2, 9, 2);
  for (int i = 0; i < 6; ++i) CHECK(one.update(buffer).critic_loss == two.update(buffer).critic_loss);
  CHECK(identical(one.networks(), two.networks()));
}

TEST_CASE("Updates with rounded products follow those in float32, at any number of threads", "[rl]") {
  Td3Config config;
  config.batch_size = 64;
  const ReplayBuffer buffer = random_buffer(500, 6);
  const auto precise = make_td3(config, 6, 2, 9, 1);
  config.products = Td3Products::kBfloat16;
  FusedTd3<float> one(config, 6, 2, 9, 1);
  FusedTd3<float> two(config, 6, 2, 9, 2);
  for (int i = 0; i < 20; ++i) {
    const double loss = one.update(buffer).critic_loss;
    CHECK(two.update(buffer).critic_loss == loss);
    CHECK(precise->update(buffer).critic_loss == Approx(loss).epsilon(0.02));
  }
  CHECK(identical(one.networks(), two.networks()));
  CHECK_FALSE(identical(one.networks(), precise->networks()));
}
