#include "lodestone/control/residual_watch.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

constexpr double kWatched_m = 0.8e-3;  // per unit of drive

control::ResidualWatch watch_of_known_rig() {
  control::MotionModel model(
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kWatched_m)), {}, 1.0);
  return {std::move(model), 0.5e-3, 0.05};
}

/// A pulse from the middle on a rig whose axes answer so strongly.
control::SeenPulse pulse_on(const Vector2& strength, common::RandomStream& random) {
  control::SeenPulse pulse;
  pulse.before = {0.001 * random.normal(), 0.001 * random.normal(), 0.2};
  pulse.drive_A = {random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)};
  pulse.after = pulse.before;
  const double noise_m = 0.5e-3;  // as identification assumes
  pulse.after.x_m += strength.x() * kWatched_m * pulse.drive_A.x() + noise_m * random.normal();
  pulse.after.y_m += strength.y() * kWatched_m * pulse.drive_A.y() + noise_m * random.normal();
  pulse.after.heading_rad += 0.05 * random.normal();
  return pulse;
}

}  // namespace

TEST_CASE("a rig that answers as identified is never told to have changed", "[unit]") {
  for (const double gain : {0.7, 1.0, 1.5}) {
    control::ResidualWatch watch = watch_of_known_rig();
    common::RandomStream random(5, "rig");
    for (int i = 0; i < 1000; ++i) {
      watch.check(pulse_on({gain, gain}, random), {std::log(gain), 0.05});
      REQUIRE_FALSE(watch.changed());
    }
  }
}

TEST_CASE("an axis that goes dead, or is turned round, is told within a few pulses", "[unit]") {
  for (const double y : {0.0, -1.0}) {
    control::ResidualWatch watch = watch_of_known_rig();
    common::RandomStream random(6, "rig");
    for (int i = 0; i < 100; ++i) watch.check(pulse_on({1.0, 1.0}, random), {0.0, 0.05});
    int pulses = 0;
    while (!watch.changed() && pulses < 1000) {
      watch.check(pulse_on({1.0, y}, random), {0.0, 0.05});
      ++pulses;
    }
    INFO("strength of y " << y << ", told after " << pulses << " pulses");
    CHECK(pulses <= 40);
    watch.reset();
    CHECK(watch.evidence() == 0.0);
  }
}

TEST_CASE("a place that holds the needle is one surprise, a needle that nothing moves is another rig",
          "[unit]") {
  const geometry::Pose2 here = {0.0, 0.0, 0.2};
  control::ResidualWatch held = watch_of_known_rig();
  for (int i = 0; i < 100; ++i) held.check({here, {5.0, 0.0}, here}, {0.0, 0.05});
  CHECK_FALSE(held.changed());
  control::ResidualWatch dead = watch_of_known_rig();
  common::RandomStream random(7, "drives");
  for (int i = 0; i < 40; ++i)
    dead.check({here, {random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0)}, here}, {0.0, 0.05});
  CHECK(dead.changed());
}
