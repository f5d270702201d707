#include "lodestone/rl/training_checkpoint.h"

#include <catch2/catch.hpp>
#include <limits>

#include <ATen/ops/zeros_like.h>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using lodestone::nets::Checkpoint;
using lodestone::rl::FlatNetwork;
using lodestone::rl::restore_numbers;

namespace {

FlatNetwork<float> checkpoint_network(std::uint64_t seed) {
  FlatNetwork<float> network({3, 5, 2});
  lodestone::common::RandomStream random(seed, "network", 0);
  network.initialise(random);
  return network;
}

}  // namespace

TEST_CASE("The numbers of a network come back from a training checkpoint", "[unit]") {
  const FlatNetwork<float> saved = checkpoint_network(1);
  Checkpoint checkpoint;
  checkpoint.parts["networks"] = saved.named(saved.parameters(), "actor.");
  FlatNetwork<float> network = checkpoint_network(2);
  CHECK_FALSE(network.parameters().equal(saved.parameters()));
  restore_numbers(checkpoint, "networks", "actor.", network, network.parameters());
  CHECK(network.parameters().equal(saved.parameters()));
  const auto arrays = lodestone::rl::arrays_of(network);
  CHECK(arrays.size() == 4);
  CHECK(arrays.at("l2.bias").shape() == std::vector<std::int64_t>{2});
}

TEST_CASE("A training checkpoint with a part missing, of another shape or not finite is refused", "[unit]") {
  FlatNetwork<float> network = checkpoint_network(1);
  Checkpoint checkpoint;
  const auto restore = [&] {
    restore_numbers(checkpoint, "networks", "actor.", network, network.parameters());
  };
  CHECK_THROWS_WITH(restore(), Catch::Contains("\"actor.l1.bias\"") && Catch::Contains("missing"));
  const FlatNetwork<float> other({3, 6, 2});
  checkpoint.parts["networks"] = other.named(other.parameters(), "actor.");
  CHECK_THROWS_AS(restore(), lodestone::common::CheckpointError);
  FlatNetwork<float> broken = checkpoint_network(1);
  broken.parameters().data_ptr<float>()[0] = std::numeric_limits<float>::quiet_NaN();
  checkpoint.parts["networks"] = broken.named(broken.parameters(), "actor.");
  CHECK_THROWS_AS(restore(), lodestone::common::CheckpointError);
}
