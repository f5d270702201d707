#include "lodestone/nets/unet.h"

#include <catch2/catch.hpp>

#include <torch/torch.h>

using namespace lodestone;

namespace {

nets::UNet small_network() {
  nets::UNetConfig config;
  config.width = 4;
  config.depth = 2;
  nets::UNet network(config);
  common::RandomStream random(1, "weights");
  network->initialise(random);
  return network;
}

}  // namespace

TEST_CASE("the mask has the image's shape, shrunk by the stem and enlarged by the upscaling") {
  nets::UNet network = small_network();
  CHECK(network->forward(torch::zeros({2, 3, 64, 96})).sizes() == torch::IntArrayRef({2, 2, 32, 48}));
  CHECK_THROWS_AS(network->forward(torch::zeros({1, 3, 60, 64})), std::logic_error);
}

TEST_CASE("a folded network is the same function in evaluation mode") {
  torch::manual_seed(1);
  nets::UNet network = small_network();
  network->fit_normaliser(torch::rand({4, 3, 64, 64}) * 255.0);
  network->train();
  for (int i = 0; i < 10; ++i) network->forward(torch::rand({4, 3, 64, 64}) * 255.0);
  network->eval();
  nets::UNet fast = nets::folded(network);
  const torch::Tensor image = torch::rand({2, 3, 64, 96}) * 255.0;
  const torch::NoGradGuard no_grad;
  CHECK((fast->forward(image) - network->forward(image)).abs().max().item<double>() < 1e-4);
}

TEST_CASE("a small U-Net learns to mark what is bright") {
  nets::UNet network = small_network();
  torch::manual_seed(2);
  torch::optim::Adam optimiser(network->parameters(), torch::optim::AdamOptions(1e-2));
  const torch::Tensor blocks = (torch::rand({8, 1, 8, 8}) > 0.7).to(torch::kFloat32);
  const torch::Tensor image = torch::upsample_nearest2d(blocks, {64, 64}).repeat({1, 3, 1, 1}) * 200.0;
  const torch::Tensor target = torch::upsample_nearest2d(blocks, {32, 32}).repeat({1, 2, 1, 1});
  double loss = 0.0;
  for (int step = 0; step < 200; ++step) {
    optimiser.zero_grad();
    const torch::Tensor error = torch::binary_cross_entropy_with_logits(network->forward(image), target);
    error.backward();
    optimiser.step();
    loss = error.item<double>();
  }
  CHECK(loss < 0.1);
}
