#include "lodestone/rl/ou_noise.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

using lodestone::rl::ExplorationNoise;
using lodestone::rl::NoiseConfig;
using lodestone::rl::NoiseKind;

namespace {

/// Mean of the products, number by number.
double mean_product(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum / static_cast<double>(a.size());
}

}  // namespace

TEST_CASE("OU noise has the stationary spread and correlation of its process", "[rl]") {
  NoiseConfig config;
  config.theta = 0.15;
  config.sigma = 0.2;
  constexpr std::int64_t kEnvironments = 64;
  constexpr int kSteps = 4000;
  ExplorationNoise noise(config, kEnvironments, 2, 7);
  for (int i = 0; i < 100; ++i) noise.next();
  std::vector<float> before = noise.next();
  double square = 0.0;
  double product = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const std::vector<float> now = noise.next();
    square += mean_product(now, now) / kSteps;
    product += mean_product(now, before) / kSteps;
    before = now;
  }
  // x' = a x + sigma n with a = 1 - theta: variance sigma^2 / (1 - a^2), lag-one correlation a
  const double a = 1.0 - config.theta;
  CHECK(square == Approx(config.sigma * config.sigma / (1.0 - a * a)).epsilon(0.03));
  CHECK(product / square == Approx(a).epsilon(0.01));
}

TEST_CASE("Gaussian noise is independent from step to step", "[rl]") {
  NoiseConfig config;
  config.kind = NoiseKind::kGaussian;
  config.sigma = 0.3;
  ExplorationNoise noise(config, 500, 2, 7);
  const std::vector<float> first = noise.next();
  double square = 0.0;
  double product = 0.0;
  std::vector<float> before = first;
  for (int i = 0; i < 200; ++i) {
    const std::vector<float> now = noise.next();
    square += mean_product(now, now) / 200;
    product += mean_product(now, before) / 200;
    before = now;
  }
  CHECK(std::sqrt(square) == Approx(0.3).epsilon(0.01));
  CHECK(std::abs(product / square) < 0.02);
}

TEST_CASE("An environment's noise does not depend on how many environments there are", "[rl]") {
  ExplorationNoise few(NoiseConfig{}, 3, 2, 11);
  ExplorationNoise many(NoiseConfig{}, 50, 2, 11);
  const auto begins_with = [](const std::vector<float>& all, const std::vector<float>& first) {
    return std::equal(first.begin(), first.end(), all.begin());
  };
  for (int i = 0; i < 20; ++i) CHECK(begins_with(many.next(), few.next()));
  CHECK(begins_with(many.uniform_actions(), few.uniform_actions()));
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
  const std::vector<float> held = still.next();
  for (const float value : held) CHECK(value != 0.0F);
  still.episode_ended(1);
  CHECK(still.next() == std::vector<float>{held[0], held[1], 0.0F, 0.0F});

  ExplorationNoise resumed(NoiseConfig{}, 2, 2, 999);
  resumed.load(saved);
  for (int i = 0; i < 5; ++i) CHECK(resumed.next() == noise.next());
  ExplorationNoise other(NoiseConfig{}, 3, 2, 3);
  CHECK_THROWS_AS(other.load(saved), lodestone::common::CheckpointError);
}
