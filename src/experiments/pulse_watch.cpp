#include "lodestone/experiments/pulse_watch.h"

#include <cmath>
#include <mutex>

#include "lodestone/common/clock.h"

namespace lodestone::experiments {

PulseWatch::PulseWatch(emulation::LiveBench& live) : live_(live) {
  live_.with([this](emulation::EmulatedBench& bench) {
    bench.watch = [this, &bench, was_on = false](double now_s, const auto&) mutable {
      bool on = false;
      for (int i = 0; i < static_cast<int>(bench.controllers()); ++i)
        for (const double duty : bench.controller(i).duty()) on = on || duty != 0.0;
      if (on && !was_on) {
        const std::lock_guard<common::PriorityMutex> lock(mutex_);
        begun_s_.push_back(now_s);
        last_wall_s_ = common::SteadyClock().now_s();
      }
      was_on = on;
    };
  });
}

PulseWatch::~PulseWatch() {
  live_.with([](emulation::EmulatedBench& bench) { bench.watch = nullptr; });
}

std::int64_t PulseWatch::pulses() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  return static_cast<std::int64_t>(begun_s_.size());
}

double PulseWatch::last_wall_s() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  return last_wall_s_;
}

std::vector<double> PulseWatch::deviations_ms(double period_s, std::int64_t from) const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  std::vector<double> deviations;
  for (std::size_t i = static_cast<std::size_t>(from) + 1; i < begun_s_.size(); ++i) {
    const double between_s = begun_s_[i] - begun_s_[i - 1];
    const double periods = std::round(between_s / period_s);
    if (periods >= 1.0)  // a step without a pose or with a drive of zero gives no pulse
      deviations.push_back(1e3 * std::abs(between_s - periods * period_s));
  }
  return deviations;
}

}  // namespace lodestone::experiments
