#include "lodestone/nets/parameters.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {
namespace {

using Catch::Contains;

TEST_CASE("a network takes up only tensors that fit", "[unit]") {
  Parameters network;
  const at::Tensor weight = network.add("weight", {2, 3});
  network.add("bias", {2});
  network.add_buffer("count", at::zeros({}, at::kLong));
  NamedTensors tensors = network.named();
  for (auto& entry : tensors) entry.second = entry.second.clone() + 1;
  network.load(tensors, "test");
  CHECK(at::equal(weight, tensors.at("weight")));

  NamedTensors missing = tensors;
  missing.erase("bias");
  CHECK_THROWS_WITH(network.load(missing, "test"), Contains("\"bias\" is missing"));
  NamedTensors unexpected = tensors;
  unexpected["extra"] = at::zeros({1});
  CHECK_THROWS_WITH(network.load(unexpected, "test"), Contains("unexpected tensor \"extra\""));
  NamedTensors reshaped = tensors;
  reshaped["bias"] = at::zeros({3});
  CHECK_THROWS_WITH(network.load(reshaped, "test"), Contains("expected [2]"));
  NamedTensors retyped = tensors;
  retyped["count"] = at::zeros({});
  CHECK_THROWS_AS(network.load(retyped, "test"), common::CheckpointError);
}

TEST_CASE("flattened parameters are one array, and gradients another", "[unit]") {
  Parameters network;
  const at::Tensor first = network.add("first", {2, 2});
  const at::Tensor second = network.add("second", {3});
  network.add_buffer("mean", at::ones({4}));
  network.load({{"first", at::full({2, 2}, 2.0)}, {"second", at::full({3}, 5.0)}, {"mean", at::ones({4})}},
               "test");
  network.flatten();
  CHECK(to_vector(network.values()) == std::vector<double>{2, 2, 2, 2, 5, 5, 5});
  for (int pass = 0; pass < 2; ++pass) {  // a second backward() adds to what the first left
    (first.sum() + 10.0 * second.square().sum()).backward();
    CHECK(to_vector(network.gradient()).front() == 1.0 + pass);
    CHECK(to_vector(network.gradient()).back() == 100.0 * (1 + pass));
  }
  network.values().zero_();
  CHECK(first.abs().max().item<double>() == 0.0);
  CHECK(network.named().at("mean").sum().item<double>() == 4.0);
}

}  // namespace
}  // namespace lodestone::nets
