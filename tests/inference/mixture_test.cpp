#include "lodestone/inference/mixture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace lodestone;
using inference::MixtureLayout;

TEST_CASE("the mean is that of the components by weight, and draws have the mixture's moments", "[unit]") {
  // Two components of two numbers: weights 0.25 and 0.75, means (0, 1) and (4, -2).
  const std::vector<float> raw = {
      std::log(0.25F), std::log(0.75F), 0.0F, 1.0F, 4.0F, -2.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const MixtureLayout layout{2, 2};
  CHECK(layout.outputs() == 10);
  const double spread = std::exp(0.5 * (inference::kLeastLogSpread + inference::kMostLogSpread));
  float out[2];
  inference::mixture_mean(raw.data(), layout, out);
  CHECK(out[0] == Approx(3.0));
  CHECK(out[1] == Approx(-1.25));
  common::RandomStream random(1, "draws");
  constexpr int kDraws = 40000;
  int first = 0;
  double square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    inference::mixture_draw(raw.data(), layout, inference::Luck::draw(layout.size, random), out);
    const bool of_first = out[0] < 2.0F;
    first += of_first ? 1 : 0;
    square += std::pow(out[0] - (of_first ? 0.0 : 4.0), 2);
  }
  CHECK(static_cast<double>(first) / kDraws == Approx(0.25).margin(0.01));
  CHECK(std::sqrt(square / kDraws) == Approx(spread).epsilon(0.02));
}

TEST_CASE("the density is the mixture's, wider where a value is noisy, and finite far away", "[unit]") {
  const std::vector<float> raw = {
      std::log(0.25F), std::log(0.75F), 0.0F, 1.0F, 4.0F, -2.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const MixtureLayout layout{2, 2};
  const double own = std::exp(0.5 * (inference::kLeastLogSpread + inference::kMostLogSpread));
  const double exact[2] = {0.0, 0.0};
  const double noise[2] = {0.3, 0.1};
  const auto by_hand = [&](const double* value, const double* noise_of) {
    const double mean[2][2] = {{0.0, 1.0}, {4.0, -2.0}};
    const double weight[2] = {0.25, 0.75};
    double sum = 0.0;
    for (int k = 0; k < 2; ++k) {
      double density = weight[k];
      for (int i = 0; i < 2; ++i) {
        const double variance = own * own + noise_of[i] * noise_of[i];
        density *= std::exp(-0.5 * std::pow(value[i] - mean[k][i], 2) / variance) /
                   std::sqrt(2.0 * 3.14159265358979 * variance);
      }
      sum += density;
    }
    return std::log(sum);
  };
  const double near[2] = {0.1, 0.95};
  CHECK(inference::mixture_log_density(raw.data(), layout, near, exact) == Approx(by_hand(near, exact)));
  CHECK(inference::mixture_log_density(raw.data(), layout, near, noise) == Approx(by_hand(near, noise)));
  const double far[2] = {400.0, -900.0};
  CHECK(std::isfinite(inference::mixture_log_density(raw.data(), layout, far, exact)));
}
