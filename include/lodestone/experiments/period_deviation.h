#pragma once

#include <array>
#include <vector>

#include "lodestone/common/statistics.h"

namespace lodestone::experiments {

/// How far the time between two pulses was from whole control periods.
struct PeriodDeviation {
  double deviation_median_ms = 0.0, deviation_p99_ms = 0.0;
  std::array<double, 2> deviation_p99_interval_ms = {};  ///< 95 %
  double deviation_max_ms = 0.0;

  PeriodDeviation() = default;
  /// At least one.
  explicit PeriodDeviation(const std::vector<double>& deviations_ms)
      : deviation_median_ms(common::percentile(deviations_ms, 0.5)),
        deviation_p99_ms(common::percentile(deviations_ms, 0.99)),
        deviation_max_ms(common::percentile(deviations_ms, 1.0)) {
    const common::Interval interval = common::percentile_interval(deviations_ms, 0.99);
    deviation_p99_interval_ms = {interval.low, interval.high};
  }

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("deviation_median_ms", deviation_median_ms);
    v.field("deviation_p99_ms", deviation_p99_ms);
    v.field("deviation_p99_interval_ms", deviation_p99_interval_ms);
    v.field("deviation_max_ms", deviation_max_ms);
  }
};

}  // namespace lodestone::experiments
