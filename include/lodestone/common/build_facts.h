#pragma once

#include <string>

#include "lodestone/common/config.h"

namespace lodestone::common {

/// Facts about this build and machine for manifests: version, git commit, compiler, host, processor, threads,
/// UTC time.
Json build_and_host_facts();

/// Now, as 2024-05-31T12:00:00Z.
std::string utc_now();

}  // namespace lodestone::common
