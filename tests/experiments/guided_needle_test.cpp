#include "lodestone/experiments/guided_needle.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/experiments/qualification.h"

using namespace lodestone;

namespace {

experiments::QualificationConfig guided() {
  experiments::QualificationConfig config;
  config.sensor.kind = "simulated";
  return config;
}

}  // namespace

TEST_CASE("a needle is brought to places, pushed, and every look is counted") {
  const experiments::QualificationConfig config = guided();
  const auto bench = experiments::make_qualification_session(config);
  experiments::GuidedNeedle needle(config.needle, config.rig, *bench);
  for (const geometry::Vector2& place_m : {geometry::Vector2(0.015, 0.0), geometry::Vector2(-0.010, 0.015)}) {
    REQUIRE(needle.bring_to(place_m, 5e-3));
    const auto here = needle.here();
    REQUIRE(here);
    CHECK((here->position_m() - place_m).norm() < 6e-3);
  }
  const std::int64_t looks = needle.refusals().figures().share.n;
  CHECK(looks > 4);
  const double start_s = bench->clock().now_s();
  const auto motion = needle.push({3.0, 0.0});
  REQUIRE(motion);
  CHECK(experiments::MotionThreshold().moved(motion->before, motion->after));
  CHECK(bench->clock().now_s() - start_s >= config.needle.loop.period_s());
  CHECK(needle.refusals().figures().share.n > looks);
  const std::int64_t counted = needle.refusals().figures().share.n;
  CHECK(needle.fresh_look().valid);
  CHECK(needle.refusals().figures().share.n == counted);
}

TEST_CASE("looks come no faster than asked for, and a pulse needs a needle that was seen") {
  experiments::QualificationConfig config = guided();
  config.needle.look_s = 0.1;
  const auto bench = experiments::make_qualification_session(config);
  experiments::GuidedNeedle needle(config.needle, config.rig, *bench);
  CHECK_THROWS_AS(needle.pulse(needle.pulse_along({1.0, 0.0}, {0.0, 0.0})), common::LogicFault);
  const double first_s = needle.look().stamp_s;
  CHECK(needle.look().stamp_s == Approx(first_s + 0.1));
  REQUIRE(needle.here());
  const rig::CoilPulse pulse = needle.pulse_along({3.0, 0.0}, {0.0, 0.0});
  CHECK(pulse.duration_s == config.needle.loop.pulse_s);
  const double start_s = bench->clock().now_s();
  needle.pulse(pulse);
  CHECK(bench->clock().now_s() == start_s);  // it is on
  needle.look_during(pulse);
  needle.rest();
  CHECK(bench->clock().now_s() == Approx(start_s + config.needle.loop.period_s()));
}

TEST_CASE("a needle that is never seen ends it, with the coils off") {
  experiments::QualificationConfig config = guided();
  config.sensor.simulated.dropout = 1.0;
  const auto bench = experiments::make_qualification_session(config);
  experiments::GuidedNeedle needle(config.needle, config.rig, *bench);
  CHECK_FALSE(needle.here());
  CHECK_FALSE(needle.push({3.0, 0.0}));
  CHECK_THROWS_AS(needle.bring_to({0.0, 0.0}, 1e-3), common::HardwareError);
  const runs::RefusalFigures refusals = needle.refusals().figures();
  CHECK(refusals.share.value == 1.0);
  CHECK(refusals.cells.empty());
}
