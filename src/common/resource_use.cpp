#include "lodestone/common/resource_use.h"

#include <sys/resource.h>

#include <ctime>

namespace lodestone::common {

double peak_memory_mb() {
  constexpr double kUnit = 1024.0;  // Linux counts in KiB
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return kUnit * static_cast<double>(usage.ru_maxrss) / 1e6;
}

double processor_seconds() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

}  // namespace lodestone::common
