#include "lodestone/common/error.h"

namespace lodestone::common {

void throw_check_failure(const char* condition, const char* file, int line, const std::string& message) {
  throw LogicFault(message + " (check `" + condition + "` failed at " + file + ":" + std::to_string(line) +
                   ")");
}

}  // namespace lodestone::common
