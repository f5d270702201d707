#include "lodestone/common/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "lodestone/common/shown.h"

namespace lodestone::common {
namespace {

spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> instance = [] {
    // https://no-color.org: set to anything but nothing, it turns colours off.
    const char* no_colour = std::getenv("NO_COLOR");
    const bool plain = no_colour != nullptr && *no_colour != '\0';
    auto made = std::make_shared<spdlog::logger>(
        "lodestone", std::make_shared<spdlog::sinks::stderr_color_sink_mt>(
                         plain ? spdlog::color_mode::never : spdlog::color_mode::automatic));
    made->set_pattern("%H:%M:%S %^%l%$ %v");
    return made;
  }();
  return *instance;
}

}  // namespace

void log_info(const std::string& message) { logger().info(escaped(message)); }
void log_warning(const std::string& message) { logger().warn(escaped(message)); }
void log_error(const std::string& message) { logger().error(escaped(message)); }

}  // namespace lodestone::common
