#include "current_watch.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodestone::rig {

namespace {
constexpr double kSteadyWithin_s = 0.1;  // a coil has its current, or after half of a shorter pulse
}

void CurrentWatch::pulse(const CoilPulse& pulse, double asked_s, double answered_s) {
  constexpr double kClocks = 0.02;  // by which the device's may be fast
  asked_A_ = pulse.current_A;
  for (std::size_t coil = 0; coil < coils_.count(); ++coil)
    off_since_s_[coil] = asked_A_[coil] != 0.0 ? answered_s + pulse.duration_s
                                               : std::min(double(off_since_s_[coil]), answered_s);
  steady_from_s_ = answered_s + std::min(kSteadyWithin_s, 0.5 * pulse.duration_s);
  steady_until_s_ = asked_s + (1.0 - kClocks) * pulse.duration_s;
  over_ = false;
}

void CurrentWatch::stop(double now_s) {
  steady_until_s_ = std::min(steady_until_s_, now_s);
  for (std::size_t coil = 0; coil < coils_.count(); ++coil)
    off_since_s_[coil] = std::min(double(off_since_s_[coil]), now_s);
}

double CurrentWatch::look_at_s(double last_s) const {
  constexpr double kBetween_s = 0.05;
  return last_s < steady_from_s_ ? steady_from_s_ : last_s + kBetween_s;
}

std::string CurrentWatch::distrust(const physics::PerCoil& measured_A, double asked_s, double answered_s) {
  constexpr double kWeak_A = 0.5;  // too little to be told from nothing
  const bool steady = asked_s >= steady_from_s_ && answered_s <= steady_until_s_;
  bool all_off = true;
  for (std::size_t coil = 0; coil < coils_.count(); ++coil) {
    const double has_A = measured_A[coil], wants_A = asked_A_[coil];
    if (!(std::abs(has_A) <= 1.25 * coils_.largest_A(coil) + 0.5))
      return fmt::format("over-current: coil {} is said to have {:g} A, its largest is {:g} A",
                         coils_.name(coil), has_A, coils_.largest_A(coil));
    const bool off = asked_s >= off_since_s_[coil] + kDriverOffWithin_s;
    all_off = all_off && off;
    if (off && std::abs(has_A) >= kDriverOff_A)
      return fmt::format("coil {} is switched off and is said to have {:g} A: cut the supply",
                         coils_.name(coil), has_A);
    if (!steady || wants_A == 0.0) continue;
    const bool too_little = std::abs(wants_A) >= kWeak_A && has_A / wants_A < 0.25;
    if (too_little || std::abs(has_A) > 1.25 * std::abs(wants_A) + 0.5)
      return fmt::format("coil {} was asked for {:g} A and is said to have {:g} A", coils_.name(coil),
                         wants_A, has_A);
  }
  over_ = all_off;
  return "";
}

}  // namespace lodestone::rig
