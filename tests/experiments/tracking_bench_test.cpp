#include "lodestone/experiments/tracking_bench.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("the head is told by the field where the tape is masked, and no trial loses its needle") {
  experiments::TrackingBenchConfig config;
  config.transitions = 2000;
  config.threads = 1;
  config.deployment.trials.count = 1;
  config.deployment.sensor.kind = "simulated";
  experiments::TrackingBench bench(config);
  bench.mask_tape();
  bench.drive();
  config.spoiled_trials = 1;
  bench.spoil();
  const experiments::MaskedTape& tape = *bench.result().masked_tape;
  CHECK(tape.steps > 1500);
  CHECK(tape.wrong <= 3);
  CHECK(tape.undecided < tape.steps / 3);
  CHECK(tape.wrong_by_nearest > tape.wrong);
  CHECK(tape.wrong_interval[1] >= tape.wrong_share);
  const experiments::TrackedTrials& trials = *bench.result().trials;
  CHECK(trials.trials == 2);
  CHECK(trials.observations > 100);
  CHECK(bench.result().masked_while_driven->steps > 50);
  CHECK(bench.result().masked_while_driven->wrong <= 1);
  CHECK(trials.lost == 0);
  REQUIRE(bench.result().spoiled.size() == 4);
  for (const experiments::SpoiledTrials& spoiled : bench.result().spoiled) {
    CHECK(spoiled.tracked.trials == 1);
    CHECK(spoiled.tracked.flipped == 0);
    CHECK(spoiled.tracked.worst_mm < 3.0);
  }
  CHECK(bench.result().spoiled[2].tracked.unseen > bench.result().spoiled[0].tracked.unseen);
  CHECK(bench.result().figures.size() == 13);
}
