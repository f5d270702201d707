#pragma once

#include <string>
#include <string_view>

namespace lodestone::common {

/// For a message: control characters, and bytes that are no UTF-8, as \n, \t or \x1b; everything else as it
/// is. The result is one line, and a terminal does nothing but show it.
std::string escaped(std::string_view text);

/// A value from outside as a message shows it: escaped, and cut after 200 characters.
std::string shown(std::string_view text);

/// Whether a text is UTF-8, as JSON must be.
bool is_utf8(std::string_view text);

}  // namespace lodestone::common
