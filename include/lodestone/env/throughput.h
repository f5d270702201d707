#pragma once

#include <cstdint>

#include "lodestone/env/vec_env.h"

namespace lodestone::env {

/// Environment steps per second over several repeats; each counts prediction, reward, ends, resets and
/// encoding.
struct Throughput {
  double median_steps_per_s = 0.0;
  double lowest_steps_per_s = 0.0;
  double highest_steps_per_s = 0.0;
  std::int64_t repeats = 0;
  std::int64_t steps_per_repeat = 0;  ///< environments times calls
};

/// Steps `environments` with random actions for about `seconds_per_repeat`, `repeats` times after a warm-up.
Throughput measure_throughput(VecEnv& environments, double seconds_per_repeat = 1.0,
                              std::int64_t repeats = 5);

}  // namespace lodestone::env
