#pragma once

#include <string>

namespace lodestone::common {

/// Messages to the person at the terminal (standard error, through spdlog). Results go to standard output
/// instead.
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

}  // namespace lodestone::common
