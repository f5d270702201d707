#pragma once

#include <string>

namespace lodestone::common {

/// Messages to the person at the terminal (standard error, through spdlog). Results go to standard output
/// instead.
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

/// Level: "quiet" shows warnings only, "normal" also information.
void set_log_level(const std::string& level);

}  // namespace lodestone::common
