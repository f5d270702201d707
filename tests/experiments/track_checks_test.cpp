#include "lodestone/experiments/track_checks.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("a needle that was moved by hand is found in three looks") {
  CHECK(experiments::looks_until_found({}, 5) <= 3);
}

TEST_CASE("a needle that is not seen gets a few weak pulses, however long") {
  const experiments::DeploymentConfig config;
  for (const std::int64_t steps : {6, 12, 24}) {
    const experiments::BlindDrive blind = experiments::drive_blind(config, steps, 3);
    CHECK(blind.pulses >= 1);
    CHECK(blind.pulses <= 6);
    CHECK(blind.most_A > 0.0);
    CHECK(blind.most_A <= 2.0);
  }
}

TEST_CASE("a needle that was hidden is found among scratches, and none of them is taken for it") {
  const experiments::DeploymentConfig config;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    INFO("seed " << seed);
    const experiments::DistractedDrive distracted = experiments::drive_distracted(config, 6, seed);
    CHECK(distracted.taken == 0);
    CHECK(distracted.found);
  }
}

TEST_CASE("a needle that lies still is never known better than an image can tell") {
  CHECK(experiments::least_spread_m({}, 60.0) >= 0.999e-4);
}

TEST_CASE("the tracker's time can be measured") { CHECK(experiments::tracker_ms({}, 100) > 0.0); }
