#pragma once

#include <string>

#include "lodestone/common/json.h"

namespace lodestone::runs {

/// Of an object that a person wrote: every key is one of `known` (an object with every key there is), and
/// what it holds is of that one's kind: text, number, truth, list or object. Throws ConfigError that begins
/// with `source` and names the key behind `prefix`.
void check_hand_written(const common::Json& object, const common::Json& known, const std::string& source,
                        const std::string& prefix = "");

}  // namespace lodestone::runs
