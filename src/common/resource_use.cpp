#include "lodestone/common/resource_use.h"

#include <sys/resource.h>
#include <unistd.h>

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

std::optional<double> other_processor_seconds() {
  // Of all processors together: user, nice, system, idle, waiting, interrupts of two kinds, and stolen.
  std::ifstream counted("/proc/stat");
  std::string label;
  double user = 0.0, nice = 0.0, system = 0.0, idle = 0.0, waiting = 0.0, hard = 0.0, soft = 0.0,
         stolen = 0.0;
  counted >> label >> user >> nice >> system >> idle >> waiting >> hard >> soft >> stolen;
  if (!counted || label != "cpu") return std::nullopt;
  const double ticks = user + nice + system + hard + soft + stolen;
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK)) - processor_seconds();
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
