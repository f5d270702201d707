#include "lodestone/rl/replay_buffer.h"

#include <catch2/catch.hpp>
#include <set>

#include <ATen/ATen.h>

#include "lodestone/common/error.h"

using lodestone::common::RandomStream;
using lodestone::env::StepResult;
using lodestone::rl::Batch;
using lodestone::rl::ReplayBuffer;

namespace {

// Transition number k holds k everywhere, so that a sampled row shows where each of its parts comes from.
void add_numbered(ReplayBuffer& buffer, int k, bool terminated, bool truncated) {
  StepResult result;
  const float number = static_cast<float>(k);
  result.final_observation.assign(3, number + 0.5F);
  result.observation.assign(3, -1.0F);
  result.reward = {10.0F * number};
  result.terminated = {static_cast<std::uint8_t>(terminated)};
  result.truncated = {static_cast<std::uint8_t>(truncated)};
  buffer.add(std::vector<float>(3, number), std::vector<float>(2, -number), result);
}

}  // namespace

TEST_CASE("A sampled row keeps its parts together, and only termination stops the bootstrap", "[rl]") {
  ReplayBuffer buffer(100, 3, 2);
  for (int k = 0; k < 40; ++k) add_numbered(buffer, k, k % 4 == 3, k % 4 == 1);
  Batch batch(400, 3, 2);
  RandomStream random(1, "test");
  buffer.sample(random, batch);
  std::set<int> seen;
  for (std::int64_t i = 0; i < 400; ++i) {
    const float number = batch.observation[i][0].item<float>();
    const int k = static_cast<int>(number);
    seen.insert(k);
    REQUIRE(batch.observation[i][2].item<float>() == number);
    REQUIRE(batch.action[i][1].item<float>() == -number);
    REQUIRE(batch.next_observation[i][1].item<float>() ==
            number + 0.5F);  // the final one, not that after the reset
    REQUIRE(batch.reward[i].item<float>() == 10.0F * number);
    REQUIRE(batch.not_done[i].item<float>() == (k % 4 == 3 ? 0.0F : 1.0F));
  }
  CHECK(seen.size() == 40);
}

TEST_CASE("The ring forgets the oldest transitions", "[rl]") {
  ReplayBuffer buffer(8, 3, 2);
  for (int k = 0; k < 21; ++k) add_numbered(buffer, k, false, false);
  CHECK(buffer.size() == 8);
  Batch batch(200, 3, 2);
  RandomStream random(1, "test");
  buffer.sample(random, batch);
  CHECK(batch.observation.min().item<float>() == 13.0F);
  CHECK(batch.observation.max().item<float>() == 20.0F);
}

TEST_CASE("A loaded buffer goes on bitwise", "[rl]") {
  ReplayBuffer buffer(8, 3, 2);
  for (int k = 0; k < 11; ++k) add_numbered(buffer, k, k == 5, false);
  ReplayBuffer loaded(8, 3, 2);
  loaded.load(buffer.save());
  for (int k = 11; k < 13; ++k) {
    add_numbered(buffer, k, false, false);
    add_numbered(loaded, k, false, false);
  }
  Batch one(64, 3, 2);
  Batch two(64, 3, 2);
  RandomStream random_one(4, "test");
  RandomStream random_two(4, "test");
  buffer.sample(random_one, one);
  loaded.sample(random_two, two);
  CHECK(at::equal(one.observation, two.observation));
  CHECK(at::equal(one.not_done, two.not_done));

  ReplayBuffer smaller(7, 3, 2);
  CHECK_THROWS_AS(smaller.load(buffer.save()), lodestone::common::CheckpointError);
  lodestone::nets::NamedTensors older = buffer.save();  // rows of 0.1.0 also said where episodes were cut
  CHECK(older.at("rows").size(1) == 3 + 2 + 3 + 2);
  older["rows"] = at::zeros({8, 11});
  CHECK_THROWS_WITH(loaded.load(older), Catch::Contains("the version it was made with"));
  CHECK_THROWS_AS(loaded.load({}), lodestone::common::CheckpointError);
}

TEST_CASE("A buffer refuses rows of another shape, and sampling when empty", "[rl]") {
  ReplayBuffer buffer(8, 4, 2);
  CHECK_THROWS_AS(add_numbered(buffer, 0, false, false), lodestone::common::LogicFault);
  Batch batch(2, 4, 2);
  RandomStream random(1, "test");
  CHECK_THROWS_AS(buffer.sample(random, batch), lodestone::common::LogicFault);
}
