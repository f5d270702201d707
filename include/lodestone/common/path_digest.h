#pragma once

#include <string>

namespace lodestone::common {

/// Lower-case hex SHA-256 of what a file holds, or of the names and contents of all files under a folder;
/// empty where there is neither. Throws IoError.
std::string path_digest(const std::string& path);

}  // namespace lodestone::common
