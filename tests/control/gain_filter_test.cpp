#include "lodestone/control/gain_filter.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using geometry::Pose2;
using geometry::Vector2;

namespace {

constexpr double kStrength_m = 0.8e-3;  // per unit of drive

std::shared_ptr<const control::LearnedSimulator> known_rig() {
  return std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kStrength_m));
}

/// Lets a rig of this gain answer to a few pulses.
void drive(control::GainFilter& filter, double gain, int pulses, double per_A = 1.0) {
  common::RandomStream random(3, "rig");
  Pose2 pose = {0.01, 0.0, 0.2};
  for (int i = 0; i < pulses; ++i) {
    const Vector2 drive_A(random.uniform(-8.0, 8.0) / per_A, random.uniform(-8.0, 8.0) / per_A);
    Pose2 after = pose;
    after.x_m += gain * kStrength_m * per_A * drive_A.x() + env::tests::kLinearNoise_m * random.normal();
    after.y_m += gain * kStrength_m * per_A * drive_A.y() + env::tests::kLinearNoise_m * random.normal();
    filter.learn({pose, drive_A, after});
    pose = after;
  }
}

}  // namespace

TEST_CASE("a rig's gain is found from a few pulses, and doubted until then", "[unit]") {
  for (const double gain : {0.6, 1.0, 1.8}) {
    INFO("gain " << gain);
    control::GainFilter filter({known_rig(), {}, 1.0}, {});
    const task::DriveGain before = filter.gain();
    CHECK(before.log_mean == Approx(0.0).margin(1e-12));
    CHECK(before.log_sigma > 0.35);
    drive(filter, gain, 10);
    const task::DriveGain after = filter.gain();
    CHECK(after.log_sigma < 0.2);
    CHECK(std::abs(after.log_mean - std::log(gain)) < 3.0 * after.log_sigma + 0.03);
    filter.reset();
    CHECK(filter.gain().log_sigma == before.log_sigma);
  }
}

TEST_CASE("what a simulator calls per cent is told in amperes", "[unit]") {
  control::GainFilter filter({known_rig(), {}, 20.0}, {});
  drive(filter, 1.5, 8, 20.0);
  CHECK(filter.gain().log_mean == Approx(std::log(1.5)).margin(0.1));
}

TEST_CASE("a step without current says nothing, and a single odd one little", "[unit]") {
  control::GainFilter filter({known_rig(), {}, 1.0}, {});
  drive(filter, 1.0, 8);
  const task::DriveGain known = filter.gain();
  filter.learn({{0.0, 0.0, 0.0}, {0.0, 0.0}, {0.02, 0.0, 0.0}});
  CHECK(filter.gain().log_mean == known.log_mean);
  filter.learn({{0.0, 0.0, 0.0}, {3.0, 0.0}, {-0.03, 0.02, 2.0}});
  CHECK(filter.gain().log_mean == Approx(known.log_mean).margin(0.02));
}

TEST_CASE("a place that holds the needle counts, and less so once the needle has left it", "[unit]") {
  const Pose2 here = {0.01, 0.0, 0.2};
  control::GainFilter filter({known_rig(), {}, 1.0}, {});
  drive(filter, 1.0, 20);
  const task::DriveGain before = filter.gain();
  filter.learn({here, {1.5, 0.0}, here});
  const double once = filter.gain().log_mean;
  for (int i = 0; i < 20; ++i) filter.learn({here, {1.5, 0.0}, here});
  const task::DriveGain held = filter.gain();
  CHECK(once < before.log_mean - 0.02);
  CHECK(held.log_mean < once - 0.1);  // so a controller pulls harder there
  drive(filter, 1.0, 6);
  CHECK(filter.gain().log_mean == Approx(before.log_mean).margin(0.1));
  control::IdentificationConfig alike;
  alike.place_sigma = 0.0;
  control::GainFilter everywhere({known_rig(), alike, 1.0}, alike);
  drive(everywhere, 1.0, 20);
  CHECK(everywhere.gain().log_sigma < before.log_sigma);
}

TEST_CASE("what a filter knows outlives it", "[unit]") {
  control::GainFilter filter({known_rig(), {}, 1.0}, {});
  drive(filter, 1.4, 5);
  control::GainFilter again({known_rig(), {}, 1.0}, {});
  again.restore(common::Json::parse(filter.save().dump()));
  for (control::GainFilter* each : {&filter, &again}) each->learn({{}, {1.5, 0.5}, {0.001, 0.0, 0.0}});
  CHECK(again.gain().log_mean == filter.gain().log_mean);
  CHECK(again.gain().log_sigma == filter.gain().log_sigma);
  CHECK_THROWS_AS(again.restore(common::Json::array({1.0})), common::DataError);
  CHECK_THROWS_AS(again.restore({{"weight", 1.0}}), common::DataError);
}

TEST_CASE("a pulse that was expected says what it says unexpected, and one that was not given nothing",
          "[unit]") {
  control::GainFilter filter({known_rig(), {}, 1.0}, {}), expecting({known_rig(), {}, 1.0}, {});
  const geometry::Pose2 here = {0.002, 0.001, 0.3};
  const geometry::Pose2 there = {0.004, 0.001, 0.3};
  const auto alike = [&] {
    CHECK(filter.gain().log_mean == expecting.gain().log_mean);
    CHECK(filter.gain().log_sigma == expecting.gain().log_sigma);
  };
  expecting.expect(here, {1.5, 0.5});
  alike();
  for (control::GainFilter* each : {&filter, &expecting}) each->learn({here, {1.5, 0.5}, there});
  CHECK(filter.gain().log_mean != 0.0);
  alike();
  expecting.expect(here, {1.0, 0.5});  // another one came of it: placed elsewhere, other drive, none
  for (control::GainFilter* each : {&filter, &expecting}) each->learn({there, {1.0, 0.5}, here});
  alike();
  expecting.expect(here, {1.0, 0.5});
  for (control::GainFilter* each : {&filter, &expecting}) each->learn({here, {1.0, -0.5}, there});
  alike();
  expecting.expect(here, {0.0, 0.0});
  for (control::GainFilter* each : {&filter, &expecting}) each->learn({here, {2.0, 0.0}, here});
  alike();
}
