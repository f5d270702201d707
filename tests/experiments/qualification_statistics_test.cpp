#include "lodestone/experiments/qualification_statistics.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"

using namespace lodestone;

namespace {

constexpr double kMilli = 1e-3;

/// Looks whose spreads are 0.05 and 0.02 mm and 0.3 degrees, and which drift along x.
std::vector<experiments::StillLook> looks(double drift_mm_per_min, double reported_mm, double reported_deg) {
  common::RandomStream random(3, "looks");
  std::vector<experiments::StillLook> made;
  for (int i = 0; i < 400; ++i) {
    experiments::StillLook look;
    look.time_s = 0.1 * i;
    look.pose.x_m = kMilli * (10.0 + drift_mm_per_min / 60.0 * look.time_s + 0.05 * random.normal());
    look.pose.y_m = kMilli * (-3.0 + 0.02 * random.normal());
    look.pose.heading_rad =
        geometry::wrap_angle(geometry::kPi + geometry::kRadPerDeg * 0.3 * random.normal());
    look.position_covariance_m2 = std::pow(kMilli * reported_mm, 2) * Eigen::Matrix2d::Identity();
    look.heading_sigma_rad = geometry::kRadPerDeg * reported_deg;
    made.push_back(look);
  }
  return made;
}

}  // namespace

TEST_CASE("spread of a still needle, and by what the sensor reports") {
  const auto figures = experiments::still_figures(looks(0.0, 0.05, 0.3), 7);
  REQUIRE(figures);
  CHECK(figures->refused == 7);
  CHECK(figures->x_mm.n == 400);
  CHECK(figures->x_mm.value == Approx(0.05).epsilon(0.12));
  CHECK(figures->y_mm.value == Approx(0.02).epsilon(0.12));
  CHECK(figures->heading_deg.value == Approx(0.3).epsilon(0.12));  // about the cut at 180 degrees
  REQUIRE(figures->x_mm.interval);
  CHECK(figures->x_mm.interval->at(0) < figures->x_mm.value);
  CHECK(figures->x_mm.interval->at(1) > figures->x_mm.value);
  REQUIRE(figures->whitened_position);
  CHECK(figures->whitened_position->value == Approx(std::sqrt(0.5 * (1.0 + 0.16))).epsilon(0.12));
  CHECK(figures->whitened_heading->value == Approx(1.0).epsilon(0.12));
  CHECK(figures->drift_mm_per_min.interval->at(0) < 0.02);

  const auto drifting = experiments::still_figures(looks(0.5, 0.05, 0.3), 0);
  CHECK(drifting->drift_mm_per_min.value == Approx(0.5).margin(0.1));
  CHECK(drifting->drift_mm_per_min.interval->at(0) > 0.3);
}

TEST_CASE("a sensor that reports no spread is not held against one, and few looks say nothing") {
  const auto figures = experiments::still_figures(looks(0.0, 0.0, 0.0), 0);
  REQUIRE(figures);
  CHECK_FALSE(figures->whitened_position);
  CHECK_FALSE(figures->reported_mm);
  CHECK(experiments::sensing_m(*figures) ==
        Approx(kMilli * std::sqrt(0.5 * (0.0025 + 0.0004))).epsilon(0.12));
  CHECK_FALSE(experiments::still_figures({}, 3));
}

TEST_CASE("motion is what neither the spread seen nor the one reported explains") {
  const auto still = experiments::still_figures(looks(0.0, 0.1, 0.3), 0);
  const experiments::MotionThreshold threshold = experiments::motion_threshold(*still);
  CHECK(threshold.distance_m == Approx(0.4 * kMilli));  // four of the reported ones are more than five seen
  CHECK(experiments::sensing_m(*still) == Approx(0.1 * kMilli));
  CHECK_FALSE(threshold.moved({0.0, 0.0, 0.0}, {0.3 * kMilli, 0.0, 0.01}));
  CHECK(threshold.moved({0.0, 0.0, 0.0}, {0.0, 0.5 * kMilli, 0.0}));
  CHECK(threshold.moved({0.0, 0.0, geometry::kPi}, {0.0, 0.0, 0.1 - geometry::kPi}));
}

TEST_CASE("what the starts explain of the same pulse is told from its scatter") {
  common::RandomStream random(5, "pulses");
  std::vector<experiments::PulseMotion> pulses;
  for (int i = 0; i < 40; ++i) {
    experiments::PulseMotion pulse;
    const double x_mm = random.normal();
    pulse.before = {kMilli * x_mm, kMilli * random.normal(), 1.5 + 0.1 * random.normal()};
    pulse.after.x_m = pulse.before.x_m + kMilli * (3.0 + 0.5 * x_mm + 0.1 * random.normal());
    pulse.after.y_m = pulse.before.y_m + kMilli * 0.1 * random.normal();
    pulses.push_back(pulse);
  }
  const auto figures = experiments::same_pulse_figures(pulses);
  REQUIRE(figures);
  CHECK(figures->step_mm.value == Approx(3.0).margin(0.4));
  CHECK(figures->scatter_mm.value == Approx(0.1).margin(0.03));
  CHECK(figures->all_mm.value > 2.0 * figures->scatter_mm.value);
  CHECK(figures->explained > 0.75);
  CHECK(figures->share_of_step.value == Approx(figures->scatter_mm.value / figures->step_mm.value));
  CHECK(figures->share_of_step.n == 40);

  const std::vector<experiments::PulseMotion> few(pulses.begin(), pulses.begin() + 5);
  CHECK(experiments::same_pulse_figures(few)->explained == Approx(0.0).margin(1e-9));
  CHECK_FALSE(experiments::same_pulse_figures({pulses[0], pulses[1]}));

  std::vector<experiments::PulseMotion> further = pulses;
  for (experiments::PulseMotion& pulse : further) pulse.after.x_m += kMilli * 0.6;
  const auto change = experiments::step_change(pulses, further);
  REQUIRE(change);
  CHECK(change->value == Approx(0.6 / 3.3).margin(0.05));
  CHECK(change->interval->at(0) > 0.0);
  CHECK(experiments::step_change(pulses, pulses)->value == Approx(0.0).margin(1e-9));
  CHECK_FALSE(experiments::step_change(pulses, {}));
}

TEST_CASE("gain, rise and delay of a current are read from what a coil reports") {
  std::vector<experiments::CurrentSample> samples;
  for (int i = 0; i < 200; ++i) {
    const double after_s = 1e-3 * i;
    const double rising_s = std::max(0.0, after_s - 0.005);
    samples.push_back({after_s, 1.5 * (1.0 - std::exp(-rising_s / 0.01))});
  }
  const auto rise = experiments::current_rise(samples, 3.0);
  REQUIRE(rise);
  CHECK(rise->gain == Approx(0.5).margin(1e-4));
  CHECK(rise->rise_s == Approx(0.01 * std::log(9.0)).margin(2e-4));
  CHECK(rise->half_s == Approx(0.005 + 0.01 * std::log(2.0)).margin(2e-4));

  for (experiments::CurrentSample& sample : samples) sample.current_A *= -1.0;
  CHECK(experiments::current_rise(samples, 3.0)->gain == Approx(-0.5).margin(1e-4));  // the other way round
  CHECK(experiments::current_rise(samples, -3.0)->half_s == Approx(rise->half_s));
  for (experiments::CurrentSample& sample : samples) sample.current_A = 0.01;
  CHECK_FALSE(experiments::current_rise(samples, 3.0));
  CHECK_FALSE(experiments::current_rise({{0.0, 0.0}, {0.1, 3.0}}, 3.0));
}

TEST_CASE("coils are held against their mean in time, and what was not measured is absent") {
  const std::vector<experiments::CurrentRise> early(3, {1.0, 0.02, 0.010});
  const std::vector<experiments::CurrentRise> late(3, {0.9, 0.03, 0.014});
  const auto coils = experiments::coil_figures({"+x", "-x", "+y"}, {early, late, {}});
  REQUIRE(coils.size() == 3);
  CHECK(coils[0].skew_ms->value == Approx(-2.0));
  CHECK(coils[1].skew_ms->value == Approx(2.0));
  CHECK(coils[1].gain->value == Approx(0.9));
  CHECK(coils[1].gain->n == 3);
  CHECK(coils[1].rise_ms->value == Approx(30.0));
  CHECK(coils[2].name == "+y");
  CHECK_FALSE(coils[2].gain);
}

TEST_CASE("latency is known better than the time between two looks, as their phase differs") {
  constexpr double kLook_s = 0.033, kTrue_s = 0.012;
  std::vector<double> moved_s;
  for (int i = 0; i < 33; ++i) {
    double look_s = kLook_s * (i + 0.5) / 33.0;
    while (look_s < kTrue_s) look_s += kLook_s;
    moved_s.push_back(look_s);
  }
  const auto figures = experiments::latency_figures(moved_s, kLook_s, 2);
  REQUIRE(figures);
  CHECK(figures->ms.value == Approx(12.0).margin(1.0));
  CHECK(figures->resolution_ms == Approx(33.0));
  CHECK(figures->unseen == 2);
  CHECK_FALSE(experiments::latency_figures({0.01, 0.02}, kLook_s, 0));
}

TEST_CASE("the error to expect: its interval covers, and failed trials are counted apart") {
  constexpr double kPerAxis_mm = 0.2;
  const double true_mm = std::sqrt(2.0) * kPerAxis_mm;
  int covered = 0, covered_p95 = 0;
  for (std::uint64_t run = 0; run < 40; ++run) {
    common::RandomStream random(7, "points", run);
    std::vector<double> errors_mm;
    for (int trial = 0; trial < 16; ++trial)
      errors_mm.push_back(std::hypot(kPerAxis_mm * random.normal(), kPerAxis_mm * random.normal()));
    const auto figures = experiments::points_figures(errors_mm, 4, std::nullopt);
    REQUIRE(figures);
    CHECK(figures->failed.value == Approx(0.2));
    CHECK(figures->failed.n == 20);
    CHECK(figures->failed.interval->at(0) < 0.1);
    CHECK(figures->failed.interval->at(1) > 0.3);
    CHECK(figures->sensed_rms_mm->value == Approx(common::root_mean_square(errors_mm)));
    CHECK(figures->sensed_rms_mm->n == 16);
    CHECK_FALSE(figures->rms_mm);
    const std::array<double, 2>& interval = *figures->sensed_rms_mm->interval;
    if (interval[0] <= true_mm && true_mm <= interval[1]) ++covered;
    const double true_p95_mm = kPerAxis_mm * std::sqrt(-2.0 * std::log(0.05));
    const std::array<double, 2>& p95 = *figures->sensed_p95_mm->interval;
    if (p95[0] <= true_p95_mm && true_p95_mm <= p95[1]) ++covered_p95;
  }
  CHECK(covered >= 28);
  CHECK(covered_p95 >= 12);  // the largest of 16 lies below it in 44 of 100
  CHECK_FALSE(experiments::points_figures({}, 0, std::nullopt));
  const auto failed = experiments::points_figures({}, 2, std::nullopt);
  REQUIRE(failed);
  CHECK(failed->failed.value == 1.0);
  CHECK_FALSE(failed->sensed_rms_mm);
  CHECK_FALSE(failed->sensed_p95_mm);
  CHECK_FALSE(experiments::points_figures({0.3, 0.2}, 0, std::nullopt)->sensed_rms_mm->interval);
}

TEST_CASE("true errors are told from sensed ones by the looks at a needle that lies still") {
  // Sensed: off the target by 0.2 mm an axis, and 0.05 mm more from look to look. Where the needle lies, each
  // look is off by another 0.1 mm an axis, which nobody sees.
  common::RandomStream random(5, "points");
  std::vector<double> sensed_mm, true_mm;
  for (int trial = 0; trial < 4000; ++trial) {
    const double x_mm = 0.2 * random.normal(), y_mm = 0.2 * random.normal();
    sensed_mm.push_back(std::hypot(x_mm + 0.05 * random.normal(), y_mm + 0.05 * random.normal()));
    true_mm.push_back(std::hypot(x_mm + 0.1 * random.normal(), y_mm + 0.1 * random.normal()));
  }
  std::optional<runs::StillFigures> still;
  still.emplace();
  still->x_mm.value = still->y_mm.value = 0.05;
  const auto rms_mm = [&] {
    const auto figures = experiments::points_figures(sensed_mm, 0, still);
    REQUIRE(figures);
    REQUIRE(figures->rms_mm);
    CHECK(figures->rms_mm->interval->at(0) < figures->rms_mm->value);
    CHECK(figures->rms_mm->interval->at(1) > figures->rms_mm->value);
    return figures->rms_mm->value;
  };
  CHECK(rms_mm() == Approx(0.2 * std::sqrt(2.0)).epsilon(0.03));  // of the rest nobody knows
  still->reported_mm = std::hypot(0.05, 0.1);
  CHECK(rms_mm() == Approx(common::root_mean_square(true_mm)).epsilon(0.03));
  still->reported_mm = 0.01;  // less than is seen
  CHECK(rms_mm() == Approx(0.2 * std::sqrt(2.0)).epsilon(0.03));
}
