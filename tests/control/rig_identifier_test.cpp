#include "lodestone/control/rig_identifier.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"

using namespace lodestone;

namespace {

constexpr double kStep_m = 0.8e-3;  // per unit of drive

control::RigIdentifier new_identifier() {
  return {
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kStep_m)), {}, 1.0};
}

/// A pulse along x that moves the needle this many times as far as the simulator says.
control::SeenPulse along_x(double factor) { return {{}, {4.0, 0.0}, {factor * 4.0 * kStep_m, 0.0, 0.0}}; }

}  // namespace

TEST_CASE("a pulse is judged by what was known before it, and once", "[unit]") {
  control::RigIdentifier identifier = new_identifier();
  for (int i = 0; i < 10; ++i) {
    identifier.learn(along_x(1.5));
    identifier.check();
  }
  CHECK(identifier.gain().log_mean == Approx(std::log(1.5)).margin(0.05));
  CHECK_FALSE(identifier.changed());
  for (int i = 0; i < 8; ++i) {
    identifier.learn({{}, {4.0, 0.0}, {-0.02 - 1e-3 * i, 0.0, 0.0}});
    identifier.check();
  }
  CHECK(identifier.changed());
  const double evidence = identifier.change_evidence();
  identifier.check();
  CHECK(identifier.change_evidence() == evidence);
  const double known = identifier.gain().log_mean;
  control::RigIdentifier again = new_identifier();
  again.restore(identifier.save());
  CHECK(again.gain().log_mean == known);
  CHECK_FALSE(again.changed());
  identifier.reset();
  CHECK_FALSE(identifier.changed());
  CHECK(identifier.gain().log_mean == Approx(0.0).margin(1e-12));
}

TEST_CASE("a flow is told apart from the gain, and is no changed rig", "[unit]") {
  constexpr double kPeriod_s = 0.3;
  control::RigIdentifier identifier = new_identifier();
  control::RigIdentifier without = {
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kStep_m)),
      [] {
        control::IdentificationConfig config;
        config.drift_m = 0.0;
        return config;
      }(),
      1.0};
  CHECK(identifier.drifts_m(0.0, kPeriod_s, 3).empty());
  constexpr double kFlow_m = 1.5e-3;  // of a needle across it
  for (int i = 0; i < 40; ++i) {
    const double way = 0.7 * i, x_m = 4.0 * kStep_m * std::cos(way), y_m = 4.0 * kStep_m * std::sin(way);
    const control::SeenPulse pulse = {
        {}, {4.0 * std::cos(way), 4.0 * std::sin(way)}, {x_m, y_m + kFlow_m, 0.0}, kPeriod_s * i};
    for (control::RigIdentifier* each : {&identifier, &without}) {
      each->learn(pulse);
      each->check();
    }
  }
  const auto drifts_m = identifier.drifts_m(40 * kPeriod_s, kPeriod_s, 3);
  REQUIRE(drifts_m.size() == 3);
  CHECK(std::hypot(drifts_m[0].x(), drifts_m[0].y() - kFlow_m) < 0.3e-3);
  CHECK(without.drifts_m(40 * kPeriod_s, kPeriod_s, 3).empty());
  CHECK_FALSE(identifier.changed());
  CHECK(std::abs(identifier.gain().log_mean) < 0.1);
  CHECK(std::abs(identifier.gain().log_mean) <= std::abs(without.gain().log_mean) + 0.01);
  const double known = identifier.gain().log_mean;
  identifier.begin_run();
  CHECK(identifier.drifts_m(0.0, kPeriod_s, 3).empty());
  CHECK(identifier.gain().log_mean == known);
}
