#include "lodestone/console/pulse_log.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace lodestone::console {

void PulseLog::apply(const rig::CoilPulse& pulse) {
  const double start_s = clock_.now_s();
  guard_.apply(pulse);
  note(pulse, start_s);
}

void PulseLog::probe(const rig::CoilPulse& pulse) {
  const double start_s = clock_.now_s();
  guard_.probe(pulse);
  note(pulse, start_s);
}

void PulseLog::stop() noexcept {
  guard_.stop();
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  if (!pulses_.empty()) {
    Logged& last = pulses_.back();
    last.pulse.duration_s = std::min(last.pulse.duration_s, clock_.now_s() - last.start_s);
  }
}

void PulseLog::note(const rig::CoilPulse& pulse, double start_s) {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  while (!pulses_.empty() && pulses_.front().start_s < start_s - 2.0 * kWindow_s) pulses_.pop_front();
  pulses_.push_back({pulse, start_s});
  if (last_s_) interval_s_ = start_s - *last_s_;
  last_s_ = start_s;
}

physics::PerCoil PulseLog::on_A(double now_s) const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  if (pulses_.empty() || now_s - pulses_.back().start_s >= pulses_.back().pulse.duration_s)
    return physics::PerCoil(coils_);
  return pulses_.back().pulse.current_A;
}

physics::PerCoil PulseLog::duty(double now_s) const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  physics::PerCoil duty(coils_);
  for (const Logged& logged : pulses_) {
    const double from_s = std::max(logged.start_s, now_s - kWindow_s);
    const double on_s = std::min(logged.start_s + logged.pulse.duration_s, now_s) - from_s;
    for (std::size_t coil = 0; coil < duty.size(); ++coil)
      if (logged.pulse.current_A[coil] != 0.0) duty[coil] += std::max(0.0, on_s) / kWindow_s;
  }
  return duty;
}

std::optional<double> PulseLog::jitter_s() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  if (!interval_s_) return std::nullopt;
  return std::abs(*interval_s_ - period_s_ * std::max(1.0, std::round(*interval_s_ / period_s_)));
}

void PulseLog::begin_run() {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  last_s_.reset();
  interval_s_.reset();
}

}  // namespace lodestone::console
