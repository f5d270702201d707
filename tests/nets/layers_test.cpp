#include "lodestone/nets/layers.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <ATen/ATen.h>

#include "lodestone/inference/batch_norm.h"

namespace lodestone::nets {
namespace {

TEST_CASE("a linear layer is its matrix and its bias", "[unit]") {
  Parameters tensors;
  Linear layer(tensors, "l", 2, 1);
  tensors.load({{"l.weight", tensor_from({3.0, -1.0}, {1, 2}, at::kFloat)},
                {"l.bias", tensor_from({0.5}, {1}, at::kFloat)}},
               "test");
  CHECK(to_vector(layer(tensor_from({1, 1, 2, 0}, {2, 2}, at::kFloat))) == std::vector<double>{2.5, 6.5});
}

TEST_CASE("initial weights follow the stream and PyTorch's default range", "[unit]") {
  Parameters tensors;
  Linear layer(tensors, "l", 64, 256);
  common::RandomStream random(1, "weights");
  layer.initialise(random);
  CHECK(layer.weight.abs().max().item<double>() <= 1.0 / 8.0);
  CHECK(layer.weight.std().item<double>() == Approx(1.0 / 8.0 / std::sqrt(3.0)).epsilon(0.05));
  const at::Tensor first = layer.weight.clone();
  common::RandomStream again(1, "weights");
  layer.initialise(again);
  CHECK(at::equal(layer.weight, first));
}

TEST_CASE("batch normalisation uses the batch in training and the running statistics afterwards", "[unit]") {
  Parameters tensors;
  const BatchNorm norm(tensors, "n", 1);
  const at::Tensor x = tensor_from({1.0, 3.0}, {2, 1}, at::kFloat);
  const at::NoGradGuard no_grad;
  CHECK(norm(x, true)[1].item<double>() == Approx(1.0 / std::sqrt(1.0 + inference::kBatchNormEpsilon)));
  // A tenth of the batch's mean 2 and unbiased variance 2, the rest from 0 and 1.
  CHECK(norm.running_mean.item<double>() == Approx(0.2));
  CHECK(norm.running_var.item<double>() == Approx(1.1));
  CHECK(norm.batches.item<int>() == 1);
  CHECK(norm(x, false)[1].item<double>() == Approx(2.8 / std::sqrt(1.1 + inference::kBatchNormEpsilon)));
  CHECK(norm.batches.item<int>() == 1);
}

}  // namespace
}  // namespace lodestone::nets
