#include "lodestone/nets/unet.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/inference/unet.h"
#include "lodestone/nets/optimiser.h"
#include "lodestone/nets/tensors.h"
#include "unet_weights.h"

using namespace lodestone;

namespace {

std::shared_ptr<nets::UNet> small_network() {
  auto network = std::make_shared<nets::UNet>(tests::small_unet());
  common::RandomStream random(1, "weights");
  network->initialise(random);
  return network;
}

}  // namespace

TEST_CASE("the mask has the image's shape, shrunk by the stem and enlarged by the upscaling") {
  const auto network = small_network();
  CHECK(network->forward(at::zeros({2, 3, 64, 96})).sizes() == at::IntArrayRef({2, 2, 32, 48}));
  CHECK_THROWS_AS(network->forward(at::zeros({1, 3, 60, 64})), std::logic_error);
}

TEST_CASE("without LibTorch and with its normalisations folded it is the same function") {
  at::manual_seed(1);
  const auto network = small_network();
  const at::NoGradGuard no_grad;
  network->fit_normaliser(at::rand({4, 3, 64, 64}) * 255.0);
  for (int i = 0; i < 10; ++i) network->forward(at::rand({4, 3, 64, 64}) * 255.0);
  network->train(false);
  const inference::UNet plain(network->config(), nets::to_arrays(network->tensors().named()), "it");
  inference::UNet::Workspace workspace;
  const at::Tensor pixels = (at::rand({64, 96, 3}) * 255.0).to(at::kByte);
  const at::Tensor logits = at::empty({1, 2, 32, 48});
  plain.forward(pixels.data_ptr<std::uint8_t>(), 64, 96, logits.data_ptr<float>(), workspace);
  const at::Tensor expected = network->forward(pixels.permute({2, 0, 1}).unsqueeze(0).to(at::kFloat));
  CHECK((logits - expected).abs().max().item<double>() < 1e-4);
}

TEST_CASE("a small U-Net learns to mark what is bright") {
  const auto network = small_network();
  network->tensors().flatten();
  at::Tensor& values = network->tensors().values();
  at::Tensor& gradient = network->tensors().gradient();
  at::Tensor first = at::zeros_like(values);
  at::Tensor second = at::zeros_like(values);
  at::manual_seed(2);
  const at::Tensor blocks = (at::rand({8, 1, 8, 8}) > 0.7).to(at::kFloat);
  const at::Tensor image = at::upsample_nearest2d(blocks, {64, 64}).repeat({1, 3, 1, 1}) * 200.0;
  const at::Tensor target = at::upsample_nearest2d(blocks, {32, 32}).repeat({1, 2, 1, 1});
  double loss = 0.0;
  for (int step = 1; step <= 200; ++step) {
    gradient.zero_();
    const at::Tensor error = at::binary_cross_entropy_with_logits(network->forward(image), target);
    error.backward();
    nets::adam_step(values.data_ptr<float>(), gradient.data_ptr<float>(), first.data_ptr<float>(),
                    second.data_ptr<float>(), static_cast<std::size_t>(values.numel()), 1e-2, step);
    loss = error.item<double>();
  }
  CHECK(loss < 0.1);
}
