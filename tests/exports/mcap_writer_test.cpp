#include "lodestone/exports/mcap_writer.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "exports/mcap_file.h"
#include "lodestone/common/error.h"
#include "temporary_folder.h"

using lodestone::exports::McapWriter;
using namespace lodestone::tests;
namespace common = lodestone::common;

namespace {

std::vector<McapRecord> with_opcode(const std::vector<McapRecord>& records, std::uint64_t opcode) {
  std::vector<McapRecord> found;
  for (const McapRecord& record : records)
    if (record.opcode == opcode) found.push_back(record);
  return found;
}

std::uint64_t crc_of(const std::string& bytes) {
  return crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
}

/// Ten messages on one topic, five on another, half a second apart.
void write_fifteen(McapWriter& writer) {
  const std::uint16_t schema = writer.add_schema("a.B", "protobuf", "descriptors");
  const std::uint16_t one = writer.add_channel("/one", schema, "protobuf");
  const std::uint16_t two = writer.add_channel("/two", schema, "protobuf");
  for (std::uint64_t i = 0; i < 10; ++i) {
    writer.write(one, i * 500'000'000, "first " + std::to_string(i));
    if (i % 2 == 0) writer.write(two, i * 500'000'000, "second " + std::to_string(i));
  }
}

}  // namespace

TEST_CASE("messages come back by topic, in chunks of two seconds") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  McapWriter writer(path);
  write_fifteen(writer);
  writer.finish();
  const auto messages = mcap_messages(path);
  REQUIRE(messages.size() == 2);
  REQUIRE(messages.at("/one").size() == 10);
  CHECK(messages.at("/one")[9] == "first 9");
  REQUIRE(messages.at("/two").size() == 5);
  CHECK(messages.at("/two")[4] == "second 8");
  CHECK(with_opcode(mcap_file_records(path), 6).size() == 3);
}

TEST_CASE("every index of a chunk leads to the messages that it names") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  McapWriter writer(path);
  write_fifteen(writer);
  writer.finish();
  const std::string bytes = common::read_file(path);
  const std::vector<McapRecord> records = mcap_file_records(path);
  const std::vector<McapRecord> chunks = with_opcode(records, 6);
  const std::vector<McapRecord> chunk_indexes = with_opcode(records, 8);
  REQUIRE(chunks.size() == chunk_indexes.size());
  std::size_t found = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    Bytes chunk_index(chunk_indexes[i].content);
    const std::uint64_t start_ns = chunk_index.number(8);
    const std::uint64_t end_ns = chunk_index.number(8);
    CHECK(chunk_index.number(8) == chunks[i].offset);
    CHECK(chunk_index.number(8) == 9 + chunks[i].content.size());
    const std::vector<McapRecord> inside = mcap_chunk_records(chunks[i].content);
    for (Bytes offsets(chunk_index.counted()); !offsets.over();) {
      const std::uint64_t channel = offsets.number(2);
      Bytes index(bytes.substr(offsets.number(8)));
      CHECK(index.number(1) == 7);
      index.number(8);
      CHECK(index.number(2) == channel);
      for (Bytes entries(index.counted()); !entries.over();) {
        const std::uint64_t time_ns = entries.number(8);
        const std::uint64_t offset = entries.number(8);
        CHECK(start_ns <= time_ns);
        CHECK(time_ns <= end_ns);
        for (const McapRecord& record : inside) {
          if (record.offset != offset) continue;
          Bytes message(record.content);
          CHECK(message.number(2) == channel);
          message.number(4);
          CHECK(message.number(8) == time_ns);
          ++found;
        }
      }
    }
  }
  CHECK(found == 15);
}

TEST_CASE("data and summary end with checksums of what comes before them") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  McapWriter writer(path);
  write_fifteen(writer);
  writer.add_metadata("what", {{"key", "value"}});
  writer.finish();
  const std::string bytes = common::read_file(path);
  const std::vector<McapRecord> records = mcap_file_records(path);
  const McapRecord data_end = with_opcode(records, 15).at(0);
  CHECK(Bytes(data_end.content).number(4) == crc_of(bytes.substr(0, data_end.offset)));
  Bytes footer(records.back().content);
  CHECK(records.back().opcode == 2);
  const std::uint64_t summary_start = footer.number(8);
  const std::uint64_t offsets_start = footer.number(8);
  CHECK(summary_start == data_end.offset + 13);
  CHECK(footer.number(4) ==
        crc_of(bytes.substr(summary_start, records.back().offset + 9 + 16 - summary_start)));
  const std::vector<McapRecord> groups = with_opcode(records, 14);
  REQUIRE(groups.size() == 5);  // schemas, channels, statistics, chunk indexes, metadata indexes
  CHECK(groups.front().offset == offsets_start);
  for (const McapRecord& group : groups) {
    Bytes fields(group.content);
    const std::uint64_t opcode = fields.number(1);
    const std::uint64_t start = fields.number(8);
    const std::uint64_t length = fields.number(8);
    for (const McapRecord& record : mcap_records(bytes.substr(start, length))) CHECK(record.opcode == opcode);
  }
  Bytes statistics(with_opcode(records, 11).at(0).content);
  CHECK(statistics.number(8) == 15);
  CHECK(statistics.number(2) == 1);
  CHECK(statistics.number(4) == 2);
  CHECK(statistics.number(4) == 0);
  CHECK(statistics.number(4) == 1);
  CHECK(statistics.number(4) == 3);
  CHECK(statistics.number(8) == 0);
  CHECK(statistics.number(8) == 4'500'000'000);
}

TEST_CASE("a chunk that is large enough is in the file at once, whatever its time") {
  const TemporaryFolder folder;
  const std::string path = folder / "log.mcap";
  McapWriter writer(path);
  const std::uint16_t channel =
      writer.add_channel("/one", writer.add_schema("a.B", "protobuf", ""), "protobuf");
  const std::uintmax_t before = std::filesystem::file_size(path);
  writer.write(channel, 5, std::string(McapWriter::kChunkBytes, 'x'));
  CHECK(std::filesystem::file_size(path) > before);
}

TEST_CASE("a file that cannot be written is named") {
  CHECK_THROWS_WITH(McapWriter("/nowhere/log.mcap"), Catch::Contains("/nowhere/log.mcap"));
  CHECK_THROWS_AS(McapWriter("/dev/full"), common::IoError);
}
