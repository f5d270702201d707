#include "lodestone/common/memory.h"

#include <sys/resource.h>

namespace lodestone::common {

double peak_memory_mb() {
  constexpr double kUnit = 1024.0;  // Linux counts in KiB
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return kUnit * static_cast<double>(usage.ru_maxrss) / 1e6;
}

}  // namespace lodestone::common
