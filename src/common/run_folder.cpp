#include "lodestone/common/run_folder.h"

#include <sys/utsname.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
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

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

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

void start_run_folder(const std::string& folder, const std::string& verb, const Json& config,
                      std::int64_t seed, bool reuse) {
  namespace fs = std::filesystem;
  if (folder.empty()) throw ConfigError(verb + " needs --out DIR: the folder to write the run into");
  if (!reuse && fs::exists(folder) && !fs::is_empty(folder))
    throw ConfigError("--out " + folder +
                      " is not empty: name a new folder, or continue the run in it with --resume");
  make_folders(folder);
  Json manifest = {{"verb", verb}, {"seed", seed}};
  if (config.contains("threads")) manifest["threads"] = config["threads"];
  manifest.update(build_and_host_facts());
  write_file_atomically(folder + "/config.json", config.dump(2) + "\n");
  write_file_atomically(folder + "/manifest.json", manifest.dump(2) + "\n");
}

}  // namespace lodestone::common
