#include "lodestone/experiments/speed.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"

using namespace lodestone;

TEST_CASE("a rate is the median of its rounds, and its fraction that of each round beside it") {
  // Both fall to a half in the second round: the machine did, the fraction does not.
  const experiments::Rate rate = experiments::rate_of({10.0, 5.0, 11.0}, 2.0, {40.0, 20.0, 40.0});
  CHECK(rate.median == 10.0);
  CHECK(rate.least == 5.0);
  CHECK(rate.most == 11.0);
  CHECK(*rate.fraction_of_peak == Approx(0.5));
  CHECK_FALSE(experiments::rate_of({1.0}, 0.0, {1.0}).fraction_of_peak);
}

TEST_CASE("a measurement reads back as it was written, and what was not measured is absent") {
  experiments::SpeedResult result;
  result.machine = {{"processor", "x"}};
  result.mbs.scales.emplace()[1024].median = 3.0;
  result.td3.autograd_one_thread.emplace().median = 4.0;
  const common::Json json = common::artefact_to_json(result);
  CHECK(json["mbs"]["by_environments"]["1024"]["median"] == 3.0);
  CHECK_FALSE(json["rig"].contains("by_environments"));
  CHECK_FALSE(json["sgemm"]["all_threads"].contains("fraction_of_peak"));
  const auto back = common::artefact_from_json<experiments::SpeedResult>(json, "speed.json");
  CHECK(common::artefact_to_json(back) == json);
}
