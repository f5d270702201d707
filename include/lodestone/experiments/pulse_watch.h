#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/common/priority_mutex.h"
#include "lodestone/emulation/live_bench.h"

namespace lodestone::experiments {

/// When each pulse began on an emulated bench, by the duty of its motor controllers. From any thread.
class PulseWatch {
 public:
  /// The only one of the bench, which must outlive it.
  explicit PulseWatch(emulation::LiveBench& live);
  ~PulseWatch();
  PulseWatch(const PulseWatch&) = delete;
  PulseWatch& operator=(const PulseWatch&) = delete;

  std::int64_t pulses() const;
  /// The last pulse's beginning on the wall clock (common::SteadyClock); long ago where there was none.
  double last_wall_s() const;
  /// How far the time between two pulses is from whole periods, from pulse `from` on.
  std::vector<double> deviations_ms(double period_s, std::int64_t from = 0) const;

 private:
  emulation::LiveBench& live_;
  mutable common::PriorityMutex mutex_;
  std::vector<double> begun_s_;
  double last_wall_s_ = -1e9;
};

}  // namespace lodestone::experiments
