#include "lodestone/experiments/emulation_bench.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("the firmware answers in time, and squares through it are as with simulated coils", "[clock]") {
  const tests::TemporaryFolder folder;
  experiments::EmulationBenchConfig config;
  config.deployment.sensor.kind = "simulated";
  config.deployment.trials.count = 1;
  config.deployment.rig.amplifier.ramp_s = 0.05;
  config.round_trips = 10;
  config.round_trip_bound_ms = 1000.0;  // a busy machine
  config.error_bound = 10.0;
  config.pulses = 0;
  experiments::EmulationBench bench(config, folder.path());
  bench.time_round_trips();
  bench.compare_squares();
  bench.inject_for_long();
  const experiments::EmulationResult& result = bench.result();
  REQUIRE(result.round_trip);
  CHECK(result.round_trip->ping_median_ms > 0.0);
  CHECK(result.round_trip->ping_p99_ms >= result.round_trip->ping_median_ms);
  REQUIRE(result.square);
  // One square in real time: on a busy machine some pulses come late. With a wrong axis or sign the needle
  // would be driven away from the square.
  CHECK(result.square->emulated_mm > 0.0);
  CHECK(result.square->emulated_mm < 3.0 * result.square->simulated_mm);
  REQUIRE(result.square->ideal_mm);  // the same without the ramp
  CHECK(*result.square->ideal_mm > 0.0);
  CHECK(*result.square->ideal_mm != result.square->simulated_mm);
  CHECK_FALSE(result.long_run);
  REQUIRE(result.figures.size() == 3);
  for (const experiments::BoundedFigure& one : result.figures) {
    CAPTURE(one.figure, one.value);
    CHECK(one.ok);
  }
  const common::Json json = common::artefact_to_json(result);
  CHECK_FALSE(json.contains("real_time"));
  CHECK(json["figures"].size() == 3);
  CHECK(common::artefact_to_json(common::artefact_from_json<experiments::EmulationResult>(json, "x")) ==
        json);
}
