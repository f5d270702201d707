#pragma once

#include <zlib.h>
#include <zstd.h>

#include <catch2/catch.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lodestone/common/files.h"

namespace lodestone::tests {

/// Reads little-endian numbers and counted strings one after the other.
class Bytes {
 public:
  explicit Bytes(std::string text) : text_(std::move(text)) {}
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const std::string bytes = take(size);
    for (std::size_t i = size; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[i]);
    return value;
  }
  std::string counted() { return take(number(4)); }
  std::string take(std::size_t size) {
    REQUIRE(at_ + size <= text_.size());
    at_ += size;
    return text_.substr(at_ - size, size);
  }
  std::string rest() { return take(text_.size() - at_); }
  bool over() const { return at_ == text_.size(); }
  std::size_t at() const { return at_; }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

struct McapRecord {
  std::uint64_t opcode;
  std::string content;
  std::size_t offset;  ///< in the bytes that it was read from
};

inline std::vector<McapRecord> mcap_records(const std::string& bytes) {
  std::vector<McapRecord> records;
  for (Bytes left(bytes); !left.over();) {
    const std::size_t offset = left.at();
    const std::uint64_t opcode = left.number(1);
    records.push_back({opcode, left.take(left.number(8)), offset});
  }
  return records;
}

/// The records of a file, without those inside its chunks; offsets are the file's.
inline std::vector<McapRecord> mcap_file_records(const std::string& path) {
  const std::string bytes = common::read_file(path);
  const std::string magic("\x89MCAP0\r\n", 8);
  REQUIRE(bytes.substr(0, 8) == magic);
  REQUIRE(bytes.substr(bytes.size() - 8) == magic);
  std::vector<McapRecord> records = mcap_records(bytes.substr(8, bytes.size() - 16));
  for (McapRecord& record : records) record.offset += 8;
  return records;
}

/// What a chunk holds, its checksum compared.
inline std::vector<McapRecord> mcap_chunk_records(const std::string& chunk) {
  Bytes fields(chunk);
  fields.take(16);  // times
  std::string records(fields.number(8), '\0');
  const std::uint64_t crc = fields.number(4);
  REQUIRE(fields.counted() == "zstd");
  const std::string packed = fields.take(fields.number(8));
  REQUIRE(ZSTD_decompress(records.data(), records.size(), packed.data(), packed.size()) == records.size());
  CHECK(crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size()) == crc);
  return mcap_records(records);
}

/// The messages of a file by topic, in the order in which they were written.
inline std::map<std::string, std::vector<std::string>> mcap_messages(const std::string& path) {
  std::map<std::uint64_t, std::string> topics;
  std::map<std::string, std::vector<std::string>> messages;
  for (const McapRecord& record : mcap_file_records(path)) {
    Bytes fields(record.content);
    if (record.opcode == 4) {
      const std::uint64_t id = fields.number(2);
      fields.number(2);
      topics[id] = fields.counted();
    }
    if (record.opcode != 6) continue;
    for (const McapRecord& inner : mcap_chunk_records(record.content)) {
      Bytes message(inner.content);
      const std::string topic = topics.at(message.number(2));
      message.take(20);
      messages[topic].push_back(message.rest());
    }
  }
  return messages;
}

}  // namespace lodestone::tests
