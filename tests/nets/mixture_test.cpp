#include "lodestone/nets/mixture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

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
const double kSpread = std::exp(0.5 * (nets::kLeastLogSpread + nets::kMostLogSpread));

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

TEST_CASE("means agree, and draws have the mixture's moments", "[unit]") {
  const torch::Tensor raw = example();
  const torch::Tensor mean = nets::mixture_mean(raw, kLayout);
  float out[2];
  nets::mixture_mean(raw.data_ptr<float>(), kLayout, out);
  CHECK(mean[0][0].item<double>() == Approx(3.0));
  CHECK(out[0] == Approx(3.0));
  CHECK(mean[0][1].item<double>() == Approx(-1.25));
  CHECK(out[1] == Approx(-1.25));
  common::RandomStream random(1, "draws");
  constexpr int kDraws = 40000;
  int first = 0;
  double square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    nets::mixture_draw(raw.data_ptr<float>(), kLayout, random, out);
    const bool of_first = out[0] < 2.0F;
    first += of_first ? 1 : 0;
    square += std::pow(out[0] - (of_first ? 0.0 : 4.0), 2);
  }
  CHECK(static_cast<double>(first) / kDraws == Approx(0.25).margin(0.01));
  CHECK(std::sqrt(square / kDraws) == Approx(kSpread).epsilon(0.02));
}
