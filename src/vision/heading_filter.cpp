#include "lodestone/vision/heading_filter.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::vision {

namespace {

using geometry::kPi;
using geometry::kRadPerDeg;

// Beyond either end of the way (overshoot, coils that are not quite where they should be, a field that
// changes as the needle moves) the chance falls by e over so much.
constexpr double kTail_rad = 7.0 * kRadPerDeg;
constexpr double kInTails = 0.3;
// A field from right behind turns the needle the longer way nearly as often; e times more seldom for each:
constexpr double kLongWay = 0.4;
constexpr double kBehind_rad = 6.0 * kRadPerDeg;
constexpr double kNever = 1e-6;
constexpr double kAnything = 1e-3;  // of all pulses do what no rule says: the needle runs against the wall
constexpr double kAnythingElse = 6e-3;  // the same of what no learned simulator says
constexpr double kUnexpected = 1e-4;  // less than any pulse leaves at an axis where it may turn the needle to
constexpr double kStill_rad =
    10.0 * kRadPerDeg;  // a needle that has turned further without a pulse was moved
constexpr double kLeastSigma_rad = 1.5 * kRadPerDeg;
constexpr double kSureOfTape = 4.6;     // log-odds of 0.99
constexpr double kMostOfOneTape = 4.5;  // log-odds that the tape of one image alone is worth
constexpr int kContradictions = 3;

}  // namespace

int HeadingFilter::bin_of(double angle_rad) {
  const double turns = angle_rad / (2.0 * kPi);
  const int bin = static_cast<int>(std::floor((turns - std::floor(turns)) * kBins));
  return std::min(bin, kBins - 1);
}

void HeadingFilter::add_peak(Histogram& to, double angle_rad, double sigma_rad, double mass) {
  const double bin_rad = 2.0 * kPi / kBins;
  const int reach = std::min(kBins / 2 - 1, static_cast<int>(std::ceil(3.0 * sigma_rad / bin_rad)));
  double sum = 0.0;
  for (int offset = -reach; offset <= reach; ++offset)
    sum += std::exp(-0.5 * std::pow(offset * bin_rad / sigma_rad, 2));
  for (int offset = -reach; offset <= reach; ++offset)
    to[static_cast<std::size_t>(bin_of(angle_rad + offset * bin_rad))] +=
        mass * std::exp(-0.5 * std::pow(offset * bin_rad / sigma_rad, 2)) / sum;
}

double HeadingFilter::mass_near(const Histogram& of, double angle_rad, double sigma_rad) {
  const double bin_rad = 2.0 * kPi / kBins;
  const int reach = std::min(kBins / 2 - 1, static_cast<int>(std::ceil(3.0 * sigma_rad / bin_rad)));
  double mass = 0.0;
  for (int offset = -reach; offset <= reach; ++offset)
    mass += of[static_cast<std::size_t>(bin_of(angle_rad + offset * bin_rad))] *
            std::exp(-0.5 * std::pow(offset * bin_rad / sigma_rad, 2));
  return mass;
}

void HeadingFilter::start_over() {
  before_.fill(1.0 / kBins);
  tape_log_odds_ = 0.0;
  tapes_ = 0;
  axis_rad_.reset();
  contradictions_ = 0;
}

void HeadingFilter::reset() {
  start_over();
  now_ = before_;
}

void HeadingFilter::pulse(double field_rad, double sticks) {
  const double bin_rad = 2.0 * kPi / kBins;
  Histogram after;
  after.fill(kAnything / kBins);
  const auto add = [&](double at_rad, double mass) {
    after[static_cast<std::size_t>(bin_of(at_rad))] += mass;
  };
  const auto spread = [&](double from_rad, double turn_rad, double mass) {
    const int bins = 1 + static_cast<int>(std::abs(turn_rad) / bin_rad);
    for (int i = 0; i < bins; ++i)
      add(from_rad + std::copysign(i * bin_rad, turn_rad), (1.0 - kInTails) * mass / bins);
    const int reach = static_cast<int>(5.0 * kTail_rad / bin_rad);
    const double share = 0.5 * kInTails * mass * (1.0 - std::exp(-bin_rad / kTail_rad));
    for (int i = 0; i < reach; ++i) {
      const double tail = share * std::exp(-i * bin_rad / kTail_rad);
      add(from_rad - std::copysign((i + 1) * bin_rad, turn_rad), tail);
      add(from_rad + turn_rad + std::copysign((i + 1) * bin_rad, turn_rad), tail);
    }
  };
  for (int i = 0; i < kBins; ++i) {
    const double mass = (1.0 - kAnything) * now_[static_cast<std::size_t>(i)];
    if (mass < 1e-12) continue;
    const double from_rad = (i + 0.5) * bin_rad;
    const double turn_rad = geometry::wrap_angle(field_rad - from_rad);
    after[static_cast<std::size_t>(i)] += sticks * mass;
    const double turns = (1.0 - sticks) * mass;
    const double long_way = kLongWay * std::exp(-(kPi - std::abs(turn_rad)) / kBehind_rad);
    spread(from_rad, turn_rad, (1.0 - long_way) * turns);
    if (long_way > kNever) spread(from_rad, turn_rad - std::copysign(2.0 * kPi, turn_rad), long_way * turns);
  }
  expect(after);
}

void HeadingFilter::pulse(const std::vector<physics::PulseOutcome>& outcomes, double known) {
  const double anything = 1.0 - known + kAnythingElse;
  Histogram after;
  after.fill(anything / (1.0 + kAnythingElse) / kBins);
  for (const physics::PulseOutcome& outcome : outcomes)
    add_peak(after, outcome.mean.heading_rad, outcome.sigma_heading_rad,
             known / (1.0 + kAnythingElse) * outcome.weight);
  expect(after);
}

/// A pulse has taken the needle to one of these headings.
void HeadingFilter::expect(const Histogram& after) {
  before_ = after;
  now_ = after;
  tape_log_odds_ = 0.0;
  tapes_ = 0;
  axis_rad_.reset();
  contradictions_ = 0;
}

void HeadingFilter::remember_tape(double angle_rad, double log_odds) {
  if (log_odds <= 0.0) return;
  const bool agrees = tapes_ > 0 && std::cos(angle_rad - tape_at_rad_) > 0.0;
  const bool replaces = tapes_ < 2 && log_odds >= std::min(tape_log_odds_, kMostOfOneTape);
  if (!agrees && !replaces) return;
  tapes_ = agrees ? tapes_ + 1 : 1;
  tape_log_odds_ = agrees ? std::max(tape_log_odds_, log_odds) : log_odds;
  tape_at_rad_ = angle_rad;
}

double HeadingFilter::see(double angle_rad, double sigma_rad, double tape_log_odds) {
  const double sigma = std::max(sigma_rad, kLeastSigma_rad);
  double there = mass_near(before_, angle_rad, sigma);
  double opposite = mass_near(before_, angle_rad + kPi, sigma);
  const auto believed = [&] {
    const double sign = std::cos(angle_rad - tape_at_rad_) >= 0.0 ? 1.0 : -1.0;
    const double tape = tapes_ > 1 ? tape_log_odds_ : std::min(tape_log_odds_, kMostOfOneTape);
    return std::log(there / opposite) + sign * tape;
  };
  const auto tape_alone = [&] {
    start_over();
    there = opposite = 1.0;
  };
  const bool moved = axis_rad_ && std::abs(std::sin(angle_rad - *axis_rad_)) > std::sin(kStill_rad);
  if (moved || there + opposite < kUnexpected) tape_alone();
  axis_rad_ = angle_rad;
  remember_tape(angle_rad, tape_log_odds);
  contradictions_ = tape_log_odds >= kSureOfTape && believed() < kSureOfTape ? contradictions_ + 1 : 0;
  if (contradictions_ >= kContradictions) {
    tape_alone();
    tape_log_odds_ = tape_log_odds;
    tape_at_rad_ = angle_rad;
    tapes_ = kContradictions;
  }
  const double probability = 1.0 / (1.0 + std::exp(-believed()));
  now_.fill(0.0);
  add_peak(now_, angle_rad, sigma, probability);
  add_peak(now_, angle_rad + kPi, sigma, 1.0 - probability);
  return probability;
}

}  // namespace lodestone::vision
