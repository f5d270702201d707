#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::common {

// Kinds are enums that have names in configurations and files. The header of an enum, whose values count from
// 0, adds beside it
//
//   enum class Shape { kDisc, kRing };
//   inline std::vector<std::string> names_of(Shape) { return {"disc", "ring"}; }
//
// A configuration then holds a Shape; its visitors read, write and document the names.

template <class Kind>
std::string name_of(Kind kind) {
  return names_of(kind).at(static_cast<std::size_t>(kind));
}

/// The value of this name, where there is one.
template <class Kind>
std::optional<Kind> find_named(const std::string& name) {
  const std::vector<std::string> names = names_of(Kind{});
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Kind>(found - names.begin());
}

}  // namespace lodestone::common
