#include "lodestone/exports/mcap_writer.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "lodestone/common/error.h"

namespace lodestone::exports {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kMetadata = 0x0c,
  kMetadataIndex = 0x0d,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

template <class Number>
std::string fixed(Number value) {
  static_assert(std::is_unsigned_v<Number>);
  std::string bytes(sizeof value, '\0');
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes[i] = static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
  return bytes;
}

/// Bytes after their length in 32 bits: strings, lists and maps.
std::string counted(std::string_view bytes) {
  return fixed(static_cast<std::uint32_t>(bytes.size())).append(bytes);
}

std::string record(Opcode opcode, std::string_view content) {
  std::string bytes(1, static_cast<char>(opcode));
  return bytes.append(fixed<std::uint64_t>(content.size())).append(content);
}

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  LODESTONE_CHECK(ZSTD_isError(size) == 0, "zstd to compress a chunk");
  out.resize(size);
  return out;
}

}  // namespace

McapWriter::McapWriter(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  append(std::string(kMagic));
  append(record(kHeader, counted("") + counted("lodestone")));
  flush();
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     const std::string& data) {
  const auto id = static_cast<std::uint16_t>(++schema_count_);  // 0 means none
  const std::string bytes = record(kSchema, fixed(id) + counted(name) + counted(encoding) + counted(data));
  append(bytes);
  schemas_ += bytes;
  return id;
}

std::uint16_t McapWriter::add_channel(const std::string& topic, std::uint16_t schema,
                                      const std::string& encoding) {
  const std::uint16_t id = channel_count_++;
  const std::string bytes =
      record(kChannel, fixed(id) + fixed(schema) + counted(topic) + counted(encoding) + counted(""));
  append(bytes);
  channels_ += bytes;
  return id;
}

void McapWriter::add_metadata(const std::string& name, const std::map<std::string, std::string>& facts) {
  std::string pairs;
  for (const auto& [key, value] : facts) pairs += counted(key) + counted(value);
  const std::string bytes = record(kMetadata, counted(name) + counted(pairs));
  metadata_indexes_ +=
      record(kMetadataIndex, fixed(size_) + fixed<std::uint64_t>(bytes.size()) + counted(name));
  ++metadata_count_;
  append(bytes);
  flush();
}

void McapWriter::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  LODESTONE_CHECK(channel < channel_count_, "a channel that was added");
  if (!chunk_.empty() && time_ns >= chunk_start_ns_ + kChunk_ns) write_chunk();
  if (chunk_.empty()) chunk_start_ns_ = chunk_end_ns_ = time_ns;
  chunk_start_ns_ = std::min(chunk_start_ns_, time_ns);
  chunk_end_ns_ = std::max(chunk_end_ns_, time_ns);
  chunk_index_[channel].push_back({time_ns, chunk_.size()});
  const auto sequence = static_cast<std::uint32_t>(message_counts_[channel]++);
  chunk_ +=
      record(kMessage, (fixed(channel) + fixed(sequence) + fixed(time_ns) + fixed(time_ns)).append(message));
  if (chunk_.size() >= kChunkBytes) write_chunk();
}

void McapWriter::flush() {
  if (!chunk_.empty()) write_chunk();
  file_.flush();
  check();
}

void McapWriter::write_chunk() {
  const std::string records = compressed(chunk_);
  const std::string chunk = record(
      kChunk, fixed(chunk_start_ns_) + fixed(chunk_end_ns_) + fixed<std::uint64_t>(chunk_.size()) +
                  fixed(crc32_of(chunk_)) + counted("zstd") + fixed<std::uint64_t>(records.size()) + records);
  std::string indexes;
  std::string offsets;
  for (const auto& [channel, entries] : chunk_index_) {
    offsets += fixed(channel) + fixed<std::uint64_t>(size_ + chunk.size() + indexes.size());
    std::string index;
    for (const IndexEntry& entry : entries) index += fixed(entry.time_ns) + fixed(entry.offset);
    indexes += record(kMessageIndex, fixed(channel) + counted(index));
  }
  chunk_indexes_ +=
      record(kChunkIndex, fixed(chunk_start_ns_) + fixed(chunk_end_ns_) + fixed(size_) +
                              fixed<std::uint64_t>(chunk.size()) + counted(offsets) +
                              fixed<std::uint64_t>(indexes.size()) + counted("zstd") +
                              fixed<std::uint64_t>(records.size()) + fixed<std::uint64_t>(chunk_.size()));
  start_ns_ = chunk_count_ == 0 ? chunk_start_ns_ : std::min(start_ns_, chunk_start_ns_);
  end_ns_ = std::max(end_ns_, chunk_end_ns_);
  ++chunk_count_;
  chunk_.clear();
  chunk_index_.clear();
  append(chunk + indexes);
  file_.flush();
  check();
}

void McapWriter::finish() {
  flush();
  append(record(kDataEnd, fixed(crc_)));
  const std::uint64_t summary_start = size_;
  std::string summary;
  std::string offsets;
  const auto add = [&](Opcode opcode, const std::string& records) {
    if (!records.empty())
      offsets += record(kSummaryOffset, std::string(1, static_cast<char>(opcode)) +
                                            fixed<std::uint64_t>(summary_start + summary.size()) +
                                            fixed<std::uint64_t>(records.size()));
    summary += records;
  };
  add(kSchema, schemas_);
  add(kChannel, channels_);
  add(kStatistics, statistics());
  add(kChunkIndex, chunk_indexes_);
  add(kMetadataIndex, metadata_indexes_);
  const std::uint64_t offsets_start = summary_start + summary.size();
  // The checksum covers the summary and the footer before its own field.
  const std::string footer = fixed(summary_start) + fixed(offsets_start);
  const std::string checked = summary + offsets + static_cast<char>(kFooter) +
                              fixed<std::uint64_t>(footer.size() + sizeof(std::uint32_t)) + footer;
  append(checked + fixed(crc32_of(checked)) + std::string(kMagic));
  file_.close();
  check();
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  std::string counts;
  for (const auto& [channel, count] : message_counts_) {
    messages += count;
    counts += fixed(channel) + fixed(count);
  }
  return record(kStatistics, fixed(messages) + fixed(schema_count_) + fixed<std::uint32_t>(channel_count_) +
                                 fixed<std::uint32_t>(0) + fixed(metadata_count_) + fixed(chunk_count_) +
                                 fixed(start_ns_) + fixed(end_ns_) + counted(counts));
}

void McapWriter::check() const {
  if (!file_) throw common::IoError("cannot write " + path_ + ": " + std::strerror(errno));
}

void McapWriter::append(const std::string& bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  check();
  size_ += bytes.size();
  crc_ = crc32_of(bytes, crc_);
}

}  // namespace lodestone::exports
