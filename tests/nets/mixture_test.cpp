#include "lodestone/nets/mixture.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <torch/torch.h>

using namespace lodestone;
using nets::MixtureLayout;

namespace {

/// Two components of two numbers: weights 0.25 and 0.75, means (0, 1) and (4, -2).
torch::Tensor example() {
  const float spread = 0.0F;
  return torch::tensor(
      {{std::log(0.25F), std::log(0.75F), 0.0F, 1.0F, 4.0F, -2.0F, spread, spread, spread, spread}});
}
const MixtureLayout kLayout{2, 2};
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
  const torch::Tensor loss =
      nets::mixture_loss(example(), torch::tensor({{x[0], x[1]}}).to(torch::kFloat32), kLayout);
  CHECK(loss.item<double>() == Approx(expected).epsilon(1e-5));
}

TEST_CASE("the mean is the plain one's", "[unit]") {
  const torch::Tensor raw = example();
  const torch::Tensor mean = nets::mixture_mean(raw, kLayout);
  float out[2];
  inference::mixture_mean(raw.data_ptr<float>(), kLayout, out);
  CHECK(mean[0][0].item<float>() == Approx(out[0]));
  CHECK(mean[0][1].item<float>() == Approx(out[1]));
}
