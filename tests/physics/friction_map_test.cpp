#include "lodestone/physics/friction_map.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

TEST_CASE("friction map has the asked mean, scatter and correlation") {
  const FrictionConfig config;
  double count = 0.0, mean = 0.0, log_mean = 0.0, log_square = 0.0, lagged = 0.0, pairs = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const FrictionMap map(config, 0.0425, seed);
    for (int i = -40; i <= 40; i += 4) {
      for (int j = -40; j <= 40; j += 4) {
        const double value = map.factor(i * 1e-3, j * 1e-3);
        REQUIRE(value > 0.0);
        const double log_value = std::log(value) + 0.5 * config.map_sigma * config.map_sigma;
        count += 1.0;
        mean += value;
        log_mean += log_value;
        log_square += log_value * log_value;
        const double next =
            std::log(map.factor((i + 4) * 1e-3, j * 1e-3)) + 0.5 * config.map_sigma * config.map_sigma;
        lagged += log_value * next;
        pairs += 1.0;
      }
    }
  }
  const double variance = log_square / count - std::pow(log_mean / count, 2);
  CHECK(mean / count == Approx(1.0).margin(0.02));
  CHECK(std::sqrt(variance) == Approx(config.map_sigma).epsilon(0.05));
  // One correlation length apart: exp(-1/2).
  CHECK(lagged / pairs / variance == Approx(std::exp(-0.5)).margin(0.06));
}

TEST_CASE("friction map follows its seed") {
  const FrictionConfig config;
  const FrictionMap a(config, 0.0425, 3), b(config, 0.0425, 3), c(config, 0.0425, 4);
  CHECK(a.factor(0.011, -0.02) == b.factor(0.011, -0.02));
  CHECK(a.factor(0.011, -0.02) != c.factor(0.011, -0.02));
  CHECK(a.factor(0.5, 0.0) == Approx(a.factor(0.043, 0.0)).epsilon(1e-4));
}

TEST_CASE("no scatter is uniform friction, and impossible friction is refused") {
  FrictionConfig config;
  config.map_sigma = 0.0;
  CHECK(FrictionMap(config, 0.0425, 1).factor(0.01, 0.02) == 1.0);
  config.kinetic_coefficient = 0.5;
  CHECK_THROWS_AS(config.validate(), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::physics
