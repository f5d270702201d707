#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// The numbers of an episode, little-endian, one array after another: what a journal holds of it, and what
/// its checksum is taken of.
std::string to_bytes(const Episode& episode);

/// Nothing when so many bytes make no episode of a dataset.
std::optional<Episode> from_bytes(std::string_view bytes, const RowLayout& layout);

/// 128 bits of a SHA-256, as hex digits.
constexpr std::size_t kChecksumDigits = 32;
std::string checksum(std::string_view bytes);
/// Throws DataError that begins with `place` when `expected` was taken of another episode.
void compare_checksum(const Episode& episode, std::string_view expected, const std::string& place);

}  // namespace lodestone::data
