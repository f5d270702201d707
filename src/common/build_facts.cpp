#include "lodestone/common/build_facts.h"

#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <thread>

#include "lodestone_build_info.h"

namespace lodestone::common {
namespace {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

Json build_and_host_facts() {
  utsname host{};
  uname(&host);
  return {{"lodestone", LODESTONE_VERSION},
          {"git_commit", LODESTONE_GIT_COMMIT},
          {"build_type", LODESTONE_BUILD_TYPE},
          {"compiler", __VERSION__},
          {"host", host.nodename},
          {"system", std::string(host.sysname) + " " + host.release},
          {"processor", processor_name()},
          {"processors", std::thread::hardware_concurrency()},
          {"time_utc", utc_now()}};
}

}  // namespace lodestone::common
