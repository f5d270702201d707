#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace lodestone::common {

using Json = nlohmann::ordered_json;

enum class JsonComments { kRefused, kAllowed };

/// The one way in which JSON is read. Throws DataError "SOURCE:LINE:COLUMN: fault" where the text is no JSON,
/// is nested deeper than 64 levels, names a key twice, holds a number that no double can, more than 10,000
/// keys in one object or more than twenty million values.
Json parse_json(std::string_view text, const std::string& source,
                JsonComments comments = JsonComments::kRefused);

/// The same of a text that may be something else; nothing when parse_json() would refuse it.
std::optional<Json> find_json(std::string_view text);

/// A value as a message shows it, on one line and cut (shown.h).
std::string shown_json(const Json& value);

}  // namespace lodestone::common
