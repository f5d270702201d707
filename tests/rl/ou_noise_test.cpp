#include "lodestone/rl/ou_noise.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

using lodestone::rl::ExplorationNoise;
using lodestone::rl::NoiseConfig;

TEST_CASE("OU noise has the stationary spread and correlation of its process", "[rl]") {
  NoiseConfig config;
  config.theta = 0.15;
  config.sigma = 0.2;
  constexpr std::int64_t kEnvironments = 64;
  constexpr int kSteps = 4000;
  ExplorationNoise noise(config, kEnvironments, 2, 7);
  for (int i = 0; i < 100; ++i) noise.next();
  torch::Tensor before = noise.next().clone();
  double square = 0.0;
  double product = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const torch::Tensor now = noise.next().clone();
    square += now.square().mean().item<double>() / kSteps;
    product += (now * before).mean().item<double>() / kSteps;
    before = now;
  }
  // x' = a x + sigma n with a = 1 - theta: variance sigma^2 / (1 - a^2), lag-one correlation a
  const double a = 1.0 - config.theta;
  CHECK(square == Approx(config.sigma * config.sigma / (1.0 - a * a)).epsilon(0.03));
  CHECK(product / square == Approx(a).epsilon(0.01));
}

TEST_CASE("Gaussian noise is independent from step to step", "[rl]") {
  NoiseConfig config;
  config.kind = "gaussian";
  config.sigma = 0.3;
  ExplorationNoise noise(config, 500, 2, 7);
  const torch::Tensor first = noise.next().clone();
  double square = 0.0;
  double product = 0.0;
  torch::Tensor before = first;
  for (int i = 0; i < 200; ++i) {
    const torch::Tensor now = noise.next().clone();
    square += now.square().mean().item<double>() / 200;
    product += (now * before).mean().item<double>() / 200;
    before = now;
  }
  CHECK(std::sqrt(square) == Approx(0.3).epsilon(0.01));
  CHECK(std::abs(product / square) < 0.02);
}

TEST_CASE("An environment's noise does not depend on how many environments there are", "[rl]") {
  ExplorationNoise few(NoiseConfig{}, 3, 2, 11);
  ExplorationNoise many(NoiseConfig{}, 50, 2, 11);
  for (int i = 0; i < 20; ++i) CHECK(torch::equal(few.next(), many.next().narrow(0, 0, 3)));
  CHECK(torch::equal(few.uniform_actions(), many.uniform_actions().narrow(0, 0, 3)));
}

TEST_CASE("The noise of an ended episode starts again from zero and goes on after loading", "[rl]") {
  NoiseConfig config;
  config.theta = 0.0;
  config.sigma = 0.0;
  ExplorationNoise still(config, 2, 2, 3);
  ExplorationNoise noise(NoiseConfig{}, 2, 2, 3);
  for (int i = 0; i < 5; ++i) noise.next();
  const auto saved = noise.save();
  still.load(saved);  // without pull or spread the loaded state stays as it is
  const torch::Tensor held = still.next().clone();
  CHECK(held.abs().min().item<float>() > 0.0F);
  still.episodes_ended(torch::tensor({0, 1}, torch::kUInt8));
  CHECK(torch::equal(still.next()[0], held[0]));
  CHECK(still.next()[1].abs().max().item<float>() == 0.0F);

  ExplorationNoise resumed(NoiseConfig{}, 2, 2, 999);
  resumed.load(saved);
  for (int i = 0; i < 5; ++i) CHECK(torch::equal(resumed.next(), noise.next()));
  ExplorationNoise other(NoiseConfig{}, 3, 2, 3);
  CHECK_THROWS_AS(other.load(saved), lodestone::common::CheckpointError);
}
