#include "lodestone/common/shown.h"

#include <fmt/core.h>

namespace lodestone::common {
namespace {

constexpr std::size_t kMostCharacters = 200;

bool continues(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
}

/// Bytes of the UTF-8 character that begins at `at`; 0 when none does. As RFC 3629: neither longer than it
/// must be, nor half a surrogate pair, nor beyond U+10FFFF.
std::size_t character_bytes(std::string_view text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  if (first < 0x80) return 1;
  if (first < 0xC2 || first > 0xF4) return 0;
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  for (std::size_t i = 1; i < bytes; ++i)
    if (!continues(text, at + i)) return 0;
  const auto second = static_cast<unsigned char>(text[at + 1]);
  const bool wrong = (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                     (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
  return wrong ? 0 : bytes;
}

/// The same when the character is one that a terminal prints: U+0080 to U+009F command it, too.
std::size_t printable_bytes(std::string_view text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  if (first < 0x20 || first == 0x7F) return 0;
  const std::size_t bytes = character_bytes(text, at);
  return bytes == 2 && first == 0xC2 && static_cast<unsigned char>(text[at + 1]) < 0xA0 ? 0 : bytes;
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

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = character_bytes(text, at);
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
}

std::string shown(std::string_view text) { return escaped(text, kMostCharacters); }

}  // namespace lodestone::common
