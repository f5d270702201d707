#include "lodestone/common/shown.h"

#include <fmt/core.h>

namespace lodestone::common {
namespace {

constexpr std::size_t kMostCharacters = 200;

bool continues(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
}

/// Bytes of the character that begins at `at` when it is to be shown as it is: printable, and UTF-8; else 0.
std::size_t printable_bytes(std::string_view text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return 0;
  for (std::size_t i = 1; i < bytes; ++i)
    if (!continues(text, at + i)) return 0;
  // U+0080 to U+009F command a terminal as well.
  return first == 0xC2 && static_cast<unsigned char>(text[at + 1]) < 0xA0 ? 0 : bytes;
}

std::string escaped_byte(char byte) {
  if (byte == '\n') return "\\n";
  if (byte == '\r') return "\\r";
  if (byte == '\t') return "\\t";
  return fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
}

std::string escaped(std::string_view text, std::size_t most) {
  std::string out;
  for (std::size_t at = 0, characters = 0; at < text.size(); ++characters) {
    if (characters == most) return out + "...";
    const std::size_t bytes = printable_bytes(text, at);
    if (bytes > 0)
      out += text.substr(at, bytes);
    else
      out += escaped_byte(text[at]);
    at += bytes > 0 ? bytes : 1;
  }
  return out;
}

}  // namespace

std::string escaped(std::string_view text) { return escaped(text, std::string::npos); }

std::string shown(std::string_view text) { return escaped(text, kMostCharacters); }

}  // namespace lodestone::common
