#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lodestone::exports {

/// Writes an MCAP file (https://mcap.dev/spec, version 0): messages in zstd chunks, each with its index, and
/// a summary at the end. A chunk reaches the file in one piece, so that one that was killed can be streamed
/// to its last whole chunk. Times are in nanoseconds. Everything throws IoError when the disk is full.
class McapWriter {
 public:
  /// A chunk ends with the message that makes it this large, or before the one that comes so long after its
  /// first.
  static constexpr std::size_t kChunkBytes = 1U << 20U;
  static constexpr std::uint64_t kChunk_ns = 2'000'000'000;

  /// Begins the file `path`, in the place of what had that name.
  explicit McapWriter(const std::string& path);
  /// Leaves the file without its summary when finish() was not called.
  ~McapWriter() = default;
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// `encoding` is "protobuf": `data` is then a FileDescriptorSet that holds message `name` and all it needs.
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& data);
  /// Messages of one schema under a topic; `encoding` is how their bytes are encoded.
  std::uint16_t add_channel(const std::string& topic, std::uint16_t schema, const std::string& encoding);
  /// Facts about the file, by name; they are in it when this returns.
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& facts);

  /// One message of a channel. Times need not grow, but readers are quicker where they do.
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message);
  /// What was written is in the file, whatever happens to the process.
  void flush();
  /// Ends the file with its summary; nothing can be written afterwards.
  void finish();

 private:
  struct IndexEntry {
    std::uint64_t time_ns;
    std::uint64_t offset;
  };
  struct Group {
    std::uint8_t opcode;
    std::uint64_t start, length;
  };

  void append(const std::string& bytes);
  void check() const;
  void write_chunk();
  std::string statistics() const;

  std::string path_;
  std::ofstream file_;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;  // of everything so far
  std::string chunk_;      // records that are not in the file yet
  std::uint64_t chunk_start_ns_ = 0, chunk_end_ns_ = 0;
  std::map<std::uint16_t, std::vector<IndexEntry>> chunk_index_;
  // For the summary.
  std::string schemas_, channels_, chunk_indexes_, metadata_indexes_;
  std::uint16_t schema_count_ = 0, channel_count_ = 0;
  std::uint32_t metadata_count_ = 0, chunk_count_ = 0;
  std::uint64_t start_ns_ = 0, end_ns_ = 0;
  std::map<std::uint16_t, std::uint64_t> message_counts_;
};

}  // namespace lodestone::exports
