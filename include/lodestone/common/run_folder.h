#pragma once

#include <cstdint>
#include <string>

#include "lodestone/common/config.h"

namespace lodestone::common {

/// Facts about this build and machine for manifests: version, git commit, compiler, host, processor, threads,
/// UTC time.
Json build_and_host_facts();

/// Makes the folder of a run and writes `config.json` (resolved) and `manifest.json` (verb, seed, threads,
/// build and host facts). Throws IoError; throws ConfigError when `folder` is not empty and `reuse` is false.
void start_run_folder(const std::string& folder, const std::string& verb, const Json& config,
                      std::int64_t seed, bool reuse);

}  // namespace lodestone::common
