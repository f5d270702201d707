#include "lodestone/rl/flat_network.h"

#include <catch2/catch.hpp>
#include <string>

#include <ATen/ATen.h>

#include "rl/td3_samples.h"

using namespace lodestone;
using rl::tests::wave;

TEST_CASE("Hand-written gradients equal LibTorch's", "[rl]") {
  rl::FlatNetwork<double> network({7, 32, 16, 3});
  common::RandomStream random(3, "init");
  network.initialise(random);
  nets::NamedTensors leaves;
  for (const auto& [name, view] : network.named(network.parameters(), ""))
    leaves[name] = view.clone().set_requires_grad(true);
  const at::Tensor input = wave(1, {9, 7}).set_requires_grad(true);
  const at::Tensor weight = wave(2, {9, 3});
  at::Tensor output = input;
  for (const std::string layer : {"l1", "l2", "l3"}) {
    output = at::linear(output, leaves.at(layer + ".weight"), leaves.at(layer + ".bias"));
    if (layer != "l3") output = output.relu();
  }
  (output * weight).sum().backward();

  const at::NoGradGuard no_grad;
  auto work = network.workspace(9);
  const double* rows = input.data_ptr<double>();
  network.forward(rows, work);
  CHECK(at::allclose(work.output, output, 0, 1e-14));
  network.backward(rows, weight.data_ptr<double>(), work, rl::FlatNetwork<double>::Wanted::kParameters);
  network.backward(rows, weight.data_ptr<double>(), work, rl::FlatNetwork<double>::Wanted::kInput);
  CHECK(at::allclose(work.input_gradient, input.grad(), 0, 1e-13));
  const nets::NamedTensors gradient = network.named(work.gradient, "");
  REQUIRE(gradient.size() == 6);
  for (const auto& [name, leaf] : leaves) CHECK(at::allclose(gradient.at(name), leaf.grad(), 0, 1e-13));
}

TEST_CASE("A clone of a network has storage of its own", "[rl]") {
  rl::FlatNetwork<float> network({3, 4, 2});
  common::RandomStream random(3, "init");
  network.initialise(random);
  const rl::FlatNetwork<float> copy = network.clone();
  CHECK(at::equal(copy.parameters(), network.parameters()));
  network.parameters().zero_();
  CHECK(copy.parameters().abs().max().item<float>() > 0.0F);
}

TEST_CASE("Layers are named from the number that is asked for", "[rl]") {
  const rl::FlatNetwork<float> network({3, 4, 2});
  const nets::NamedTensors named = network.named(network.parameters(), "critic.", 4);
  REQUIRE(named.size() == 4);
  CHECK(named.at("critic.l4.weight").sizes() == at::IntArrayRef({4, 3}));
  CHECK(named.at("critic.l5.bias").sizes() == at::IntArrayRef({2}));
}
