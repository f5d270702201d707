#pragma once

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodestone/common/files.h"

namespace lodestone::tests {

/// Bodies of all records of the one event file in `folder`.
inline std::vector<std::string> event_records(const std::string& folder) {
  std::string bytes;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().filename().string().find("tfevents") != std::string::npos)
      bytes = common::read_file(entry.path().string());
  }
  std::vector<std::string> records;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at, 8);
    REQUIRE(at + 16 + length <= bytes.size());
    records.push_back(bytes.substr(at + 12, length));
    at += 16 + length;
  }
  return records;
}

/// One protocol-buffer message, field by field: numbers in `numbers`, the rest as bytes.
struct Message {
  std::map<int, std::uint64_t> numbers;
  std::map<int, std::string> bytes;

  explicit Message(const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
      const std::uint64_t key = varint(text, at);
      const int field = static_cast<int>(key >> 3U);
      switch (key & 7U) {
        case 0:
          numbers[field] = varint(text, at);
          break;
        case 1:
          bytes[field] = take(text, at, 8);
          break;
        case 2:
          bytes[field] = take(text, at, varint(text, at));
          break;
        case 5:
          bytes[field] = take(text, at, 4);
          break;
        default:
          FAIL("wire type " << (key & 7U));
      }
    }
  }
  static std::uint64_t varint(const std::string& text, std::size_t& at) {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      REQUIRE(at < text.size());
      const auto byte = static_cast<unsigned char>(text[at++]);
      value |= static_cast<std::uint64_t>(byte & 0x7fU) << shift;
      if (byte < 0x80U) return value;
    }
  }
  static std::string take(const std::string& text, std::size_t& at, std::uint64_t size) {
    REQUIRE(at + size <= text.size());
    const std::string part = text.substr(at, size);
    at += size;
    return part;
  }
};

}  // namespace lodestone::tests
