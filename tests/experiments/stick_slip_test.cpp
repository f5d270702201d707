#include "lodestone/experiments/stick_slip.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/random.h"

using namespace lodestone;
using experiments::WeakPulse;

namespace {

/// Pulses of one level, of which so many move the needle.
void add_level(std::vector<WeakPulse>& pulses, std::size_t level, double current_A, int count, int moved,
               std::size_t place = 0, std::optional<std::size_t> coil = {}) {
  for (int i = 0; i < count; ++i) {
    WeakPulse pulse;
    pulse.place = place;
    pulse.level = level;
    pulse.current_A = current_A;
    pulse.coil = coil;
    pulse.moved = i < moved;
    pulses.push_back(pulse);
  }
}

/// A step of so many mm along the drive, and as much again where the needle points along it.
void add_steps(std::vector<WeakPulse>& pulses, std::size_t level, double step_mm, double scatter_mm,
               common::RandomStream& random) {
  for (int i = 0; i < 400; ++i) {
    WeakPulse pulse;
    pulse.level = level;
    pulse.current_A = 0.5 * static_cast<double>(level + 1);
    pulse.drive_rad = 0.5 * geometry::kPi * (i % 4);
    const double off_rad = random.uniform(-1.0, 1.0);
    pulse.motion.before = {0.001, -0.002, pulse.drive_rad + off_rad};
    const double along_mm = step_mm * (1.0 + std::cos(off_rad)) + scatter_mm * random.normal();
    const double across_mm = scatter_mm * random.normal();
    const double cosine = std::cos(pulse.drive_rad), sine = std::sin(pulse.drive_rad);
    pulse.motion.after = pulse.motion.before;
    pulse.motion.after.x_m += 1e-3 * (cosine * along_mm - sine * across_mm);
    pulse.motion.after.y_m += 1e-3 * (sine * along_mm + cosine * across_mm);
    pulse.moved = true;
    pulses.push_back(pulse);
  }
}

}  // namespace

TEST_CASE("the break-away current lies where every other pulse moves the needle") {
  std::vector<WeakPulse> pulses;
  CHECK_FALSE(experiments::breakaway_A(pulses));
  add_level(pulses, 0, 1.0, 4, 0);
  add_level(pulses, 1, 1.4, 4, 1);
  CHECK_FALSE(experiments::breakaway_A(pulses));
  add_level(pulses, 2, 1.96, 4, 3);
  CHECK(*experiments::breakaway_A(pulses) == Approx(1.4 * std::sqrt(1.4)));

  std::vector<WeakPulse> at_once;
  add_level(at_once, 0, 0.5, 4, 4);
  CHECK(*experiments::breakaway_A(at_once) == Approx(0.5));  // at most that
}

TEST_CASE("places are summed up, and one where nothing moves says how far was tried") {
  std::vector<WeakPulse> pulses;
  for (std::size_t place = 0; place < 4; ++place) {
    add_level(pulses, 0, 1.0, 6, 0, place);
    if (place < 3) add_level(pulses, 1, 1.0 + 0.5 * static_cast<double>(place), 6, 6, place);
  }
  const auto figures = experiments::stick_slip_figures(pulses, 0.0);
  REQUIRE(figures);
  REQUIRE(figures->places.size() == 4);
  CHECK(figures->places[0].current_A);
  CHECK_FALSE(figures->places[3].current_A);
  CHECK(figures->places[3].tried_up_to_A == Approx(1.0));
  CHECK(figures->places[3].pulses == 6);
  REQUIRE(figures->current_A);
  CHECK(figures->current_A->n == 3);
  CHECK(figures->current_A->value == Approx((1.0 + std::sqrt(1.5) + std::sqrt(2.0)) / 3.0));
  REQUIRE(figures->spread);
  CHECK(figures->spread->value > 0.1);
  CHECK_FALSE(experiments::stick_slip_figures({}, 0.0));
}

TEST_CASE("what a heading explains of a step is no scatter, and the sensor's part is taken off") {
  common::RandomStream random(9, "weak pulses");
  std::vector<WeakPulse> pulses;
  add_steps(pulses, 0, 0.5, 0.1, random);
  const auto levels = experiments::step_levels(pulses, 0.0);
  REQUIRE(levels.size() == 1);
  CHECK(levels[0].n == 400);
  CHECK(levels[0].moved == 400);
  CHECK(levels[0].step_mm == Approx(0.5 * (1.0 + std::sin(1.0))).margin(0.03));
  CHECK(levels[0].scatter_mm == Approx(0.1).margin(0.01));
  CHECK(experiments::step_levels(pulses, 0.05e-3)[0].scatter_mm ==
        Approx(std::sqrt(0.01 - 0.005)).margin(0.015));
  CHECK(experiments::step_levels(pulses, 1e-3)[0].scatter_mm == Approx(0.03).margin(0.005));  // never nothing
  pulses.resize(5);
  CHECK(experiments::step_levels(pulses, 0.0).empty());
}

TEST_CASE("a coil of half the gain needs twice the current to move the needle") {
  std::vector<WeakPulse> pulses;
  for (std::size_t coil = 0; coil < 3; ++coil)
    for (std::size_t level = 0; level < 4; ++level) {
      const double current_A = std::pow(2.0, static_cast<double>(level));
      add_level(pulses, level, current_A, 4, current_A >= (coil == 1 ? 4.0 : 2.0) ? 4 : 0, 0, coil);
    }
  add_level(pulses, 0, 0.1, 4, 4, 1, 1);  // elsewhere it is another thing
  const auto gains = experiments::gains_by_motion(pulses, 0, 4);
  REQUIRE(gains.size() == 4);
  REQUIRE(gains[1]);
  CHECK(gains[1]->value == Approx(0.5 * gains[0]->value));
  CHECK(gains[0]->value == Approx(1.2));
  CHECK(gains[0]->n == 16);
  CHECK_FALSE(gains[3]);
}
