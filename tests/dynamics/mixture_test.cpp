#include "lodestone/dynamics/mixture.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <ATen/ATen.h>

#include "lodestone/nets/tensors.h"

using namespace lodestone;
using dynamics::mixture_loss;
using dynamics::mixture_mean;

namespace {

/// Two components of two numbers: weights 0.25 and 0.75, means (0, 1) and (4, -2).
at::Tensor example() {
  return nets::tensor_from({std::log(0.25), std::log(0.75), 0, 1, 4, -2, 0, 0, 0, 0}, {1, 10}, at::kFloat);
}
const inference::MixtureLayout kLayout{2, 2};
const double kSpread = std::exp(0.5 * (inference::kLeastLogSpread + inference::kMostLogSpread));

}  // namespace

TEST_CASE("the loss is the negative log-likelihood", "[unit]") {
  const double x[2] = {0.1, 0.9};
  const auto density = [&](double a, double b) {
    const double da = (x[0] - a) / kSpread;
    const double db = (x[1] - b) / kSpread;
    return std::exp(-0.5 * (da * da + db * db)) / (kSpread * kSpread);
  };
  const double expected = -std::log(0.25 * density(0, 1) + 0.75 * density(4, -2)) / 2.0;
  const at::Tensor loss =
      mixture_loss(example(), nets::tensor_from({x[0], x[1]}, {1, 2}, at::kFloat), kLayout);
  CHECK(loss.item<double>() == Approx(expected).epsilon(1e-5));
}

TEST_CASE("the mean's squared error counts besides as much as is told", "[unit]") {
  const at::Tensor target = nets::tensor_from({1.0, 0.25}, {1, 2}, at::kFloat);  // the mean is (3, -1.25)
  const auto loss = [&](double mean_weight) {
    return mixture_loss(example(), target, kLayout, mean_weight).item<double>();
  };
  CHECK(loss(2.0) - loss(0.0) == Approx(2.0 * (2.0 * 2.0 + 1.5 * 1.5) / 2.0).epsilon(1e-5));
}

TEST_CASE("the mean is the plain one's", "[unit]") {
  const at::Tensor raw = example();
  const at::Tensor mean = mixture_mean(raw, kLayout);
  float out[2];
  inference::mixture_mean(raw.data_ptr<float>(), kLayout, out);
  CHECK(mean[0][0].item<float>() == Approx(out[0]));
  CHECK(mean[0][1].item<float>() == Approx(out[1]));
}
