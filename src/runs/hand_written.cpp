#include "hand_written.h"

#include "lodestone/common/error.h"

namespace lodestone::runs {
namespace {

using common::ConfigError;
using common::Json;

/// What a value of this kind is called; empty: nothing is asked of it.
std::string kind(const Json& value) {
  if (value.is_boolean()) return "true or false";
  if (value.is_number_integer()) return "a whole number";
  if (value.is_number()) return "a number";
  if (value.is_string()) return "text in quotes";
  if (value.is_array()) return "a list [...]";
  if (value.is_object()) return "an object {...}";
  return "";
}

bool same_kind(const Json& value, const Json& known) {
  if (known.is_number_float()) return value.is_number();
  return kind(value) == kind(known);
}

}  // namespace

void check_hand_written(const Json& object, const Json& known, const std::string& source,
                        const std::string& prefix) {
  for (const auto& [key, value] : object.items()) {
    const std::string given = prefix + key + " = " + common::shown_json(value);
    if (!known.contains(key)) throw ConfigError(source + ": unknown key " + given);
    if (!value.is_null() && !known[key].is_null() && !same_kind(value, known[key]))
      throw ConfigError(source + ": " + given + " must be " + kind(known[key]));
  }
}

}  // namespace lodestone::runs
