#include "lodestone/experiments/expected_error.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/random.h"

using namespace lodestone;
using experiments::ErrorSources;

namespace {

ErrorSources sources(double sensing_mm, double smallest_mm, double floor_mm, double growth) {
  ErrorSources made;
  made.sensing_mm = sensing_mm;
  made.steps = {smallest_mm, floor_mm, growth};
  return made;
}

}  // namespace

TEST_CASE("a needle is left where the next step would bring it no closer") {
  const double root = std::sqrt(0.5 * geometry::kPi);
  CHECK(experiments::rest_distance_mm(sources(0.0, 0.05, 0.2, 0.0)) == Approx(0.2 * root));
  CHECK(experiments::rest_distance_mm(sources(0.1, 0.0, 0.0, 0.0)) == Approx(0.1 * std::sqrt(2.0) * root));
  // Scatter that grows with the step: r^2 = (pi / 2) (floor^2 + growth^2 r^2).
  const double rest_mm = experiments::rest_distance_mm(sources(0.0, 0.05, 0.2, 0.4));
  CHECK(rest_mm * rest_mm == Approx(0.5 * geometry::kPi * (0.04 + 0.16 * rest_mm * rest_mm)));
  // A smallest step that is far longer than its scatter: half of it, and a little.
  CHECK(experiments::rest_distance_mm(sources(0.0, 2.0, 0.1, 0.0)) ==
        Approx(1.0 + 0.25 * geometry::kPi * 0.01 / 2.0));
  CHECK(experiments::rest_distance_mm(sources(0.0, 0.05, 0.2, 0.9)) == Approx(5.0));
  experiments::ErrorModel impatient;
  impatient.patience = 2.0;
  CHECK(experiments::rest_distance_mm(sources(0.0, 0.05, 0.2, 0.0), impatient) == Approx(0.4 * root));
  impatient.aim = 2.0;
  CHECK(experiments::rest_distance_mm(sources(0.0, 0.05, 0.2, 0.0), impatient) == Approx(0.8 * root));
}

TEST_CASE("without overshoot the error is a Rayleigh distribution that is cut where the needle is left") {
  const experiments::PointErrors errors = experiments::point_errors(sources(0.0, 0.01, 0.2, 0.0));
  // Of x = e^2 / (2 s^2), exponential up to pi / 4.
  const double cut = 0.25 * geometry::kPi;
  const double mean = 1.0 - cut * std::exp(-cut) / (1.0 - std::exp(-cut));
  CHECK(errors.rms_mm == Approx(0.2 * std::sqrt(2.0 * mean)).epsilon(0.06));
  const double last = -std::log(1.0 - 0.95 * (1.0 - std::exp(-cut)));
  CHECK(errors.p95_mm == Approx(0.2 * std::sqrt(2.0 * last)).epsilon(0.06));
  CHECK(experiments::point_errors(sources(0.0, 0.01, 0.2, 0.0)).rms_mm == errors.rms_mm);
}

TEST_CASE("what is worse on the bench makes the error worse") {
  const double plain_mm = experiments::point_errors(sources(0.05, 0.1, 0.1, 0.1)).rms_mm;
  CHECK(experiments::point_errors(sources(0.3, 0.1, 0.1, 0.1)).rms_mm > 1.5 * plain_mm);
  CHECK(experiments::point_errors(sources(0.05, 0.1, 0.3, 0.1)).rms_mm > 1.5 * plain_mm);
  CHECK(experiments::point_errors(sources(0.05, 1.0, 0.1, 0.1)).rms_mm > 1.5 * plain_mm);
  CHECK(experiments::point_errors(sources(0.05, 0.1, 0.1, 0.6)).rms_mm > 1.1 * plain_mm);
  ErrorSources blind = sources(0.05, 0.1, 0.1, 0.1);
  blind.refused = 0.5;
  CHECK(experiments::point_errors(blind).rms_mm < 1.2 * plain_mm);  // there is time for that
  blind.refused = 1.0;
  CHECK(experiments::point_errors(blind).rms_mm == Approx(10.0));
}

TEST_CASE("the error to expect comes with intervals, and says what of it is the sensor's") {
  common::RandomStream random(4, "weak pulses");
  std::vector<experiments::WeakPulse> pulses;
  for (std::size_t level = 0; level < 3; ++level)
    for (int i = 0; i < 40; ++i) {
      experiments::WeakPulse pulse;
      pulse.level = level;
      pulse.current_A = static_cast<double>(level + 1);
      pulse.drive_rad = 0.5 * geometry::kPi * (i % 4);
      pulse.motion.before.heading_rad = pulse.drive_rad + random.uniform(-0.5, 0.5);
      pulse.motion.after = pulse.motion.before;
      const double step_mm = 0.2 * static_cast<double>(level + 1);
      pulse.motion.after.x_m += 1e-3 * (std::cos(pulse.drive_rad) * step_mm + 0.15 * random.normal());
      pulse.motion.after.y_m += 1e-3 * (std::sin(pulse.drive_rad) * step_mm + 0.15 * random.normal());
      pulse.moved = true;
      pulses.push_back(pulse);
    }
  const auto figures = experiments::expected_error(pulses, 0.02e-3, 0.01, 66);
  REQUIRE(figures);
  CHECK(figures->smallest_step_mm == Approx(0.2).margin(0.08));
  CHECK(figures->scatter_floor_mm == Approx(0.15).margin(0.05));
  CHECK(figures->rms_mm.n == 120);
  REQUIRE(figures->rms_mm.interval);
  CHECK(figures->rms_mm.interval->at(0) <= figures->rms_mm.value);
  CHECK(figures->rms_mm.interval->at(1) >= figures->rms_mm.value);
  CHECK(figures->p95_mm.value > figures->rms_mm.value);
  CHECK(figures->by_sensing < 0.3);
  CHECK(experiments::expected_error(pulses, 0.1e-3, 0.01, 66)->by_sensing > figures->by_sensing);

  for (experiments::WeakPulse& pulse : pulses) pulse.moved = false;
  CHECK_FALSE(experiments::expected_error(pulses, 0.02e-3, 0.01, 66));
}
