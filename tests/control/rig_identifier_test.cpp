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
