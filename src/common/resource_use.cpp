#include "lodestone/common/resource_use.h"

#include <sys/resource.h>

#include <ctime>
#include <filesystem>
#include <fstream>

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

std::map<std::string, double> processor_seconds_by_thread() {
  std::map<std::string, double> used_s;
  std::error_code ignored;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", ignored)) {
    std::string name;
    double ran_ns = 0.0;
    std::ifstream(task.path() / "comm") >> name;
    std::ifstream(task.path() / "schedstat") >> ran_ns;
    used_s[name] += 1e-9 * ran_ns;
  }
  return used_s;
}

}  // namespace lodestone::common
