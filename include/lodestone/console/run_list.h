#pragma once

#include <string>

#include "lodestone/common/json.h"

namespace lodestone::console {

constexpr const char* kRuns = "/runs/";              ///< where runs are served,
constexpr const char* kRecordings = "/recordings/";  ///< and recordings

/// The path of an address, for a file whose name may hold anything: RFC 3986, 2.1.
std::string percent_encoded(const std::string& path);

/// All runs below a folder, as pages have them (docs/console-protocol.md): how far each is, and the address
/// of its report. Throws DataError where the state of one cannot be read.
common::Json run_list(const std::string& folder);

/// All recordings in a folder, likewise.
common::Json recording_list(const std::string& folder);

}  // namespace lodestone::console
