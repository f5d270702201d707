#include "lodestone/common/tensorboard.h"

#include <array>
#include <chrono>
#include <cstring>

#include "lodestone/common/error.h"

namespace lodestone::common {
namespace {

/// CRC-32C (Castagnoli), reflected, one byte at a time.
std::uint32_t crc32c(const std::string& bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value & 1U) != 0 ? (value >> 1) ^ 0x82f63b78U : value >> 1;
      made[i] = value;
    }
    return made;
  }();
  std::uint32_t crc = 0xffffffffU;
  for (const char byte : bytes) crc = table[(crc ^ static_cast<unsigned char>(byte)) & 0xffU] ^ (crc >> 8);
  return crc ^ 0xffffffffU;
}

template <class Value>
std::string little_endian(Value value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string masked_crc(const std::string& bytes) {
  const std::uint32_t crc = crc32c(bytes);
  return little_endian<std::uint32_t>(((crc >> 15) | (crc << 17)) + 0xa282ead8U);
}

// Protocol-buffer fields by wire type: 0 varint, 1 eight bytes, 2 length-delimited, 5 four bytes.
std::string varint(std::uint64_t value) {
  std::string bytes;
  do {
    bytes.push_back(static_cast<char>((value & 0x7fU) | (value > 0x7fU ? 0x80U : 0U)));
    value >>= 7;
  } while (value != 0);
  return bytes;
}

std::string tag(int field, int wire_type) {
  return varint(static_cast<std::uint64_t>(field << 3 | wire_type));
}
std::string bytes_field(int field, const std::string& value) {
  return tag(field, 2) + varint(value.size()) + value;
}

double unix_time_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

TensorBoardWriter::TensorBoardWriter(const std::string& folder) {
  const std::string path = folder + "/events.out.tfevents." +
                           std::to_string(static_cast<std::int64_t>(unix_time_s())) + ".lodestone";
  file_.open(path, std::ios::binary | std::ios::app);
  if (!file_) throw IoError("cannot write " + path);
  write_record(tag(1, 1) + little_endian(unix_time_s()) + bytes_field(3, "brain.Event:2"));
}

void TensorBoardWriter::write(std::int64_t step, const std::vector<std::pair<std::string, double>>& scalars) {
  std::string summary;
  for (const auto& [name, value] : scalars) {
    summary += bytes_field(1, bytes_field(1, name) + tag(2, 5) + little_endian(static_cast<float>(value)));
  }
  write_record(tag(1, 1) + little_endian(unix_time_s()) + tag(2, 0) +
               varint(static_cast<std::uint64_t>(step)) + bytes_field(5, summary));
}

void TensorBoardWriter::write_record(const std::string& event) {
  const std::string length = little_endian<std::uint64_t>(event.size());
  file_ << length << masked_crc(length) << event << masked_crc(event) << std::flush;
}

}  // namespace lodestone::common
