#include "lodestone/experiments/qualification.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>

#include "lodestone/common/artefact.h"

using namespace lodestone;

namespace {

experiments::QualificationConfig short_qualification(double minutes) {
  experiments::QualificationConfig config;
  config.sensor.kind = "simulated";
  config.rig.simulation.deviation = rig::DeviationWidth::kNone;
  config.minutes = minutes;
  return config;
}

runs::QualificationResult qualified(const experiments::QualificationConfig& config) {
  const auto bench = experiments::make_qualification_session(config);
  return experiments::Qualification(config, *bench).run();
}

const runs::QualifiedItem& item_of(const runs::QualificationResult& result, const std::string& name) {
  const auto found = std::find_if(result.items.begin(), result.items.end(),
                                  [&](const runs::QualifiedItem& item) { return item.item == name; });
  REQUIRE(found != result.items.end());
  return *found;
}

/// Coils of which one gives half of what it is asked for, and which may report no currents.
class HalvedCoil final : public rig::Coils {
 public:
  HalvedCoil(rig::Coils& inner, bool reports) : inner_(inner), reports_(reports) {}
  void apply(const rig::CoilPulse& pulse) override {
    rig::CoilPulse given = pulse;
    if (given.current_A.size() > kHalved) given.current_A[kHalved] *= 0.5;
    inner_.apply(given);
  }
  void stop() noexcept override { inner_.stop(); }
  rig::CoilStatus status() override {
    rig::CoilStatus status = inner_.status();
    if (!reports_) status.current_A = physics::PerCoil();
    return status;
  }

  static constexpr std::size_t kHalved = 2;

 private:
  rig::Coils& inner_;
  bool reports_;
};

runs::QualificationResult qualified_with_half_a_coil(const experiments::QualificationConfig& config,
                                                     bool reports) {
  rig::VirtualRig rig(config.rig, 1);
  HalvedCoil halved(rig.coils(), reports);
  const session::Sensing sensing(config.sensor, config.rig);
  const auto sensor = sensing.make(rig, sensing.calibrated_bench(1), common::RandomStream(1, "sensor noise"));
  safety::Supervisor coils(halved, config.safety, config.rig, rig.clock());
  session::RigSession::Parts parts;
  parts.coils = &coils;
  parts.sensor = sensor.get();
  parts.clock = &rig.clock();
  parts.fits = [&rig](const geometry::Pose2& pose) { return rig.fits(pose); };
  session::RigSession bench(parts);
  return experiments::Qualification(config, bench).run();
}

}  // namespace

TEST_CASE("a virtual bench is qualified item by item within its time, each time the same") {
  const experiments::QualificationConfig config = short_qualification(2.0);
  const auto bench = experiments::make_qualification_session(config);
  std::map<std::string, int> told;
  experiments::Qualification work(config, *bench, [&told](double, const std::string& item) { ++told[item]; });
  const runs::QualificationResult result = work.run();
  CHECK_FALSE(result.stopped);
  CHECK(result.minutes <= 2.5);
  CHECK(told.size() >= 7);
  REQUIRE(result.still);
  CHECK(result.still->x_mm.n > 50);
  CHECK(result.still->x_mm.value == Approx(0.015).margin(0.006));  // sensor.simulated.repeatability_m
  CHECK(result.still->whitened_position->value < 1.0);
  REQUIRE(result.refusals);
  CHECK(result.refusals->share.n > 100);
  REQUIRE(result.latency);
  CHECK(result.latency->ms.value < 60.0);
  CHECK(result.latency->resolution_ms == Approx(1e3 * config.needle.look_s));
  REQUIRE(result.same_pulse);
  CHECK(result.same_pulse->step_mm.value > 0.3);
  REQUIRE(result.coils.size() == 4);
  for (const runs::CoilFigures& coil : result.coils) {
    REQUIRE(coil.gain);
    CHECK(coil.gain->value == Approx(1.0).margin(0.04));
    CHECK(coil.rise_ms->value == Approx(20.4).margin(3.0));  // ln 9 L / R
    CHECK(coil.skew_ms->value == Approx(0.0).margin(1.0));
    CHECK(*coil.last_C >= *coil.first_C);
  }
  REQUIRE(result.stick_slip);
  CHECK(result.stick_slip->current_A);
  CHECK(result.stick_slip->levels.size() >= 3);
  CHECK(result.items.size() == 14);
  CHECK_FALSE(result.mend_first.empty());
  CHECK(common::artefact_to_json(qualified(config)) == common::artefact_to_json(result));
}

TEST_CASE("friction that scatters more is seen to scatter more") {
  experiments::QualificationConfig config = short_qualification(3.0);
  config.rig.friction.map_sigma = 0.05;
  config.rig.friction.pulse_sigma = 0.02;
  const runs::QualificationResult smooth = qualified(config);
  config.rig.friction.pulse_sigma = 0.6;
  const runs::QualificationResult rough = qualified(config);
  REQUIRE(smooth.same_pulse);
  REQUIRE(rough.same_pulse);
  CHECK(rough.same_pulse->share_of_step.value > 1.3 * smooth.same_pulse->share_of_step.value);
}

TEST_CASE("a worse sensor is seen to be worse") {
  experiments::QualificationConfig config = short_qualification(2.0);
  const runs::QualificationResult good = qualified(config);
  config.sensor.simulated.repeatability_m *= 10.0;
  config.sensor.simulated.position_rms_m *= 5.0;
  config.sensor.simulated.dropout = 0.5;
  const runs::QualificationResult bad = qualified(config);
  REQUIRE(bad.still);
  CHECK(bad.still->x_mm.value > 5.0 * good.still->x_mm.value);
  CHECK(bad.still->refused > 3);
  CHECK(bad.refusals->share.value > 2.0 * good.refusals->share.value);
  CHECK(good.refusals->share.value < 0.15);
  CHECK(item_of(bad, "repeatability of position").verdict != "good");
  CHECK(item_of(good, "repeatability of position").verdict == "good");
}

TEST_CASE("a coil of half its gain is told") {
  const runs::QualificationResult result =
      qualified_with_half_a_coil(short_qualification(1.5), /*reports=*/true);
  CHECK_FALSE(result.stopped);
  REQUIRE(result.coils.size() == 4);
  for (std::size_t coil = 0; coil < 4; ++coil) {
    REQUIRE(result.coils[coil].gain);
    CHECK(result.coils[coil].gain->value == Approx(coil == HalvedCoil::kHalved ? 0.5 : 1.0).margin(0.04));
  }
  CHECK(item_of(result, "gain of a coil, off 1 by").verdict == "mend");
}

TEST_CASE("where coils report no currents that is said") {
  const runs::QualificationResult result =
      qualified_with_half_a_coil(short_qualification(0.5), /*reports=*/false);
  for (const runs::CoilFigures& coil : result.coils) {
    CHECK_FALSE(coil.gain);
    CHECK(coil.why.find("the coils report none") != std::string::npos);
  }
  CHECK(item_of(result, "gain of a coil, off 1 by").verdict == "not measured");
}

TEST_CASE("what was measured until a stop is kept, and the coils are off") {
  const experiments::QualificationConfig config = short_qualification(2.0);
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, [&bench](double, const std::string& item) {
    if (item == "latency") bench->coils().request_stop("somebody said so");
  });
  const runs::QualificationResult result = work.run();
  REQUIRE(result.stopped);
  CHECK(result.stopped->find("somebody said so") != std::string::npos);
  CHECK(bench->coils().latched());
  CHECK(result.still);
  CHECK(result.coils.front().gain);
  CHECK_FALSE(result.latency);
  const rig::CoilStatus status = bench->coils().status();
  for (const double current_A : status.current_A) CHECK(std::abs(current_A) < 0.1);
}
