#include "lodestone/common/tensorboard.h"

#include <array>
#include <cstring>

#include "lodestone/common/clock.h"
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
std::string bytes_field(int field, std::string_view value) {
  return (tag(field, 2) + varint(value.size())).append(value);
}
std::string number_field(int field, std::int64_t value) {
  return tag(field, 0) + varint(static_cast<std::uint64_t>(value));
}

std::string double_field(int field, double value) { return tag(field, 1) + little_endian(value); }

/// google.protobuf.Value
std::string value_message(const Json& value) {
  if (value.is_boolean()) return number_field(4, value.get<bool>() ? 1 : 0);
  if (value.is_number()) return double_field(2, value.get<double>());
  return bytes_field(3, value.is_string() ? value.get<std::string>() : value.dump());
}

constexpr const char* kHParams = "hparams";
constexpr int kFloatType = 1;    // DataType of TensorProto
constexpr int kStringType = 7;   // likewise
constexpr int kTensorClass = 2;  // DataClass of SummaryMetadata
constexpr int kSuccess = 1;      // Status of SessionEndInfo

/// One float, which the HParams page takes no notice of but wants to be there.
std::string null_tensor() {
  const std::string one_dimension = bytes_field(2, number_field(1, 1));
  return number_field(1, kFloatType) + bytes_field(2, one_dimension) + bytes_field(5, little_endian(0.0F));
}

}  // namespace

TensorBoardWriter::TensorBoardWriter(const std::string& folder) {
  const std::string path = folder + "/events.out.tfevents." +
                           std::to_string(static_cast<std::int64_t>(unix_time_s())) + ".lodestone";
  file_.open(path, std::ios::binary | std::ios::app);
  if (!file_) throw IoError("cannot write " + path);
  write_record(tag(1, 1) + little_endian(unix_time_s()) + bytes_field(3, "brain.Event:2"));
}

void TensorBoardWriter::start_at(std::int64_t step) {
  // Event.session_log with SessionLog.status = START.
  write_record(tag(1, 1) + little_endian(unix_time_s()) + number_field(2, step) +
               bytes_field(7, number_field(1, 1)));
}

void TensorBoardWriter::write(std::int64_t step, const std::vector<std::pair<std::string, double>>& scalars) {
  std::string summary;
  for (const auto& [name, value] : scalars)
    summary += bytes_field(1, bytes_field(1, name) + tag(2, 5) + little_endian(static_cast<float>(value)));
  write_summary(step, summary);
}

void TensorBoardWriter::write_image(std::int64_t step, const std::string& name, std::string_view png,
                                    std::int64_t width, std::int64_t height) {
  LODESTONE_CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n" && width > 0 && height > 0,
                  "image '" + name + "' must be a PNG of positive size");
  // Summary.Image: height, width, colorspace (3 = RGB), encoded image.
  const std::string image =
      number_field(1, height) + number_field(2, width) + number_field(3, 3) + bytes_field(4, png);
  write_summary(step, bytes_field(1, bytes_field(1, name) + bytes_field(4, image)));
}

void TensorBoardWriter::write_text(std::int64_t step, const std::string& name, const std::string& markdown) {
  const std::string scalar_shape;
  write_plugin(step, name,
               number_field(1, kStringType) + bytes_field(2, scalar_shape) + bytes_field(8, markdown), "text",
               "");
}

void TensorBoardWriter::start_session(const Json& settings) {
  std::string info;
  for (const auto& [name, value] : settings.items())
    info += bytes_field(1, bytes_field(1, name) + bytes_field(2, value_message(value)));
  info += double_field(5, unix_time_s());
  write_plugin(0, "_hparams_/session_start_info", null_tensor(), kHParams, bytes_field(3, info));
}

void TensorBoardWriter::end_session() {
  const std::string info = number_field(1, kSuccess) + double_field(2, unix_time_s());
  write_plugin(0, "_hparams_/session_end_info", null_tensor(), kHParams, bytes_field(4, info));
}

void TensorBoardWriter::write_plugin(std::int64_t step, const std::string& name, const std::string& tensor,
                                     const std::string& plugin, const std::string& content) {
  const std::string metadata =
      bytes_field(1, bytes_field(1, plugin) + bytes_field(2, content)) + number_field(4, kTensorClass);
  write_summary(step,
                bytes_field(1, bytes_field(1, name) + bytes_field(8, tensor) + bytes_field(9, metadata)));
}

void TensorBoardWriter::write_summary(std::int64_t step, const std::string& summary) {
  write_record(tag(1, 1) + little_endian(unix_time_s()) + number_field(2, step) + bytes_field(5, summary));
}

void TensorBoardWriter::write_record(const std::string& event) {
  const std::string length = little_endian<std::uint64_t>(event.size());
  file_ << length << masked_crc(length) << event << masked_crc(event) << std::flush;
  if (!file_) throw IoError("cannot write the TensorBoard events: is the disk full?");
}

}  // namespace lodestone::common
