#include "lodestone/vision/heading_filter.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

using namespace lodestone;
using geometry::kRadPerDeg;
using vision::HeadingFilter;

namespace {

constexpr double kSigma_rad = 0.5 * kRadPerDeg;
constexpr double kTape = 6.0;  // log-odds of a tape that is well seen

/// Two images of a needle whose tape is well seen.
void show_head(HeadingFilter& filter, double angle_deg) {
  for (int image = 0; image < 2; ++image) filter.see(angle_deg * kRadPerDeg, kSigma_rad, kTape);
}

double see_deg(HeadingFilter& filter, double angle_deg, double tape = 0.0) {
  return filter.see(angle_deg * kRadPerDeg, kSigma_rad, tape);
}

}  // namespace

TEST_CASE("at first only the tape tells the head") {
  HeadingFilter filter;
  CHECK(see_deg(filter, 30.0) == Approx(0.5));
  CHECK(see_deg(filter, 30.0, kTape) < 0.99);  // one image may err
  CHECK(see_deg(filter, 30.0, kTape) == Approx(1.0 / (1.0 + std::exp(-kTape))));
}

TEST_CASE("a needle that lies still keeps its head") {
  HeadingFilter filter;
  show_head(filter, 30.0);
  filter.pulse(33.0 * kRadPerDeg);
  CHECK(see_deg(filter, 31.0) > 0.99);
  filter.pulse(33.0 * kRadPerDeg);
  CHECK(see_deg(filter, 31.0 + 180.0) < 0.01);
}

TEST_CASE("a needle that turns towards the field has its head on the way there, however far it turns") {
  for (const double turned_deg : {20.0, 66.0, 97.0, 130.0}) {
    CAPTURE(turned_deg);
    HeadingFilter filter;
    show_head(filter, -10.0);
    filter.pulse(130.0 * kRadPerDeg);
    CHECK(see_deg(filter, -10.0 + turned_deg) > 0.99);
    filter.pulse((turned_deg - 10.0 + 90.0) * kRadPerDeg);  // and goes on from there
    CHECK(see_deg(filter, -10.0 + turned_deg + 45.0 + 180.0) < 0.01);
  }
}

TEST_CASE("a field from behind may turn it either way, and then nobody knows") {
  HeadingFilter filter;
  show_head(filter, 0.0);
  filter.pulse(178.0 * kRadPerDeg);
  const double probability = see_deg(filter, 90.0);
  CHECK(probability > 0.1);
  CHECK(probability < 0.9);
  show_head(filter, 90.0);
  CHECK(see_deg(filter, 90.0) > 0.99);  // but for the tape
}

TEST_CASE("images of a needle that lies still are no new evidence, but a tape that insists is") {
  HeadingFilter filter;
  show_head(filter, 0.0);
  filter.pulse(5.0 * kRadPerDeg);
  CHECK(see_deg(filter, 180.0, 2.0) < 0.05);
  for (int image = 0; image < 20; ++image) CHECK(see_deg(filter, 180.0, 2.0) < 0.05);
  for (int image = 0; image < 2; ++image) CHECK(see_deg(filter, 180.0, kTape) < 0.99);
  CHECK(see_deg(filter, 180.0, kTape) > 0.99);  // somebody has turned it
}

TEST_CASE("a tape that was clear in one image is remembered in the next") {
  HeadingFilter filter;
  show_head(filter, 0.0);
  CHECK(see_deg(filter, 0.2) > 0.99);
  CHECK(see_deg(filter, 180.2) < 0.01);
}

TEST_CASE("a needle that turned without a field was moved by somebody: the tape alone counts") {
  HeadingFilter filter;
  show_head(filter, 0.0);
  CHECK(see_deg(filter, 120.0) == Approx(0.5));
  show_head(filter, -60.0);
  CHECK(see_deg(filter, -60.0) > 0.99);
  filter.pulse(-40.0 * kRadPerDeg);
  CHECK(see_deg(filter, 60.0) == Approx(0.5).margin(0.05));  // where no turn towards that field ends
  show_head(filter, 60.0);
  CHECK(see_deg(filter, 60.0) > 0.99);
}

TEST_CASE("steps that were not seen leave open what they may have done") {
  HeadingFilter filter;
  show_head(filter, 0.0);
  filter.pulse(100.0 * kRadPerDeg);
  filter.pulse(100.0 * kRadPerDeg);
  CHECK(see_deg(filter, 60.0) > 0.99);
}

// A needle that obeys the rule, and one time in 2,500 does not.
TEST_CASE("what is called sure is right as often as that says") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  HeadingFilter filter;
  double heading_rad = 0.3;
  show_head(filter, heading_rad / kRadPerDeg);
  int sure = 0;
  int wrong = 0;
  constexpr int kSteps = 20000;
  for (int step = 0; step < kSteps; ++step) {
    const double field_rad = geometry::kPi * (2.0 * unit(random) - 1.0);
    filter.pulse(field_rad);
    if (unit(random) > 0.4) heading_rad += unit(random) * geometry::wrap_angle(field_rad - heading_rad);
    if (unit(random) < 4e-4) heading_rad = 2.0 * geometry::kPi * unit(random);
    const bool tape_seen = unit(random) < 0.3;
    const bool shown_turned = !tape_seen && unit(random) < 0.5;  // without a tape either end may be named
    const double probability =
        filter.see(heading_rad + (shown_turned ? geometry::kPi : 0.0), kSigma_rad, tape_seen ? kTape : 0.0);
    const double right = shown_turned ? 1.0 - probability : probability;
    if (std::max(right, 1.0 - right) < 0.99) continue;
    ++sure;
    wrong += right < 0.5 ? 1 : 0;
  }
  CHECK(sure > 0.8 * kSteps);
  CHECK(wrong < 0.002 * kSteps);
}

TEST_CASE("where a learned simulator says where the head may be, the end of the axis that it says is taken") {
  vision::HeadingFilter filter;
  for (int look = 0; look < 2; ++look) filter.see(0.0, 0.02, 20.0);
  const std::vector<physics::PulseOutcome> outcomes = {{0.8, {0.0, 0.0, 2.4}, 1e-3, 1e-3, 0.3},
                                                       {0.2, {0.0, 0.0, 0.1}, 1e-3, 1e-3, 0.1}};
  filter.pulse(outcomes, 0.999);
  SECTION("as expected") { CHECK(filter.see(2.5, 0.02, 0.0) > 0.99); }
  SECTION("from the other end") { CHECK(filter.see(2.5 - geometry::kPi, 0.02, 0.0) < 0.01); }
  SECTION("where nothing was said of either end") {
    const double there = filter.see(1.0, 0.02, 0.0);
    CHECK(there > 0.01);
    CHECK(there < 0.99);
  }
}

TEST_CASE("a head that was not known is not known after a pulse, whatever a simulator says") {
  vision::HeadingFilter filter;
  filter.see(0.0, 0.02, 0.5);
  filter.pulse({{1.0, {0.0, 0.0, 1.0}, 1e-3, 1e-3, 0.3}}, 0.6);
  CHECK(filter.see(1.0, 0.02, 0.0) < 0.99);
}
