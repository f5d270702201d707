#include "lodestone/common/metrics.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/tensorboard.h"
#include "temporary_folder.h"

using namespace lodestone::common;

namespace {

/// Bodies of all records of the one event file in `folder`.
std::vector<std::string> event_records(const std::string& folder) {
  std::string bytes;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().filename().string().find("tfevents") != std::string::npos)
      bytes = read_file(entry.path().string());
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

}  // namespace

TEST_CASE("metrics are one flushed JSON object a line, and appending goes on") {
  const lodestone::tests::TemporaryFolder folder;
  for (int run = 0; run < 2; ++run) {
    MetricsLog log(folder.path());
    log.write(run, {{"train/loss", 0.5 + run}});
  }
  std::istringstream lines(read_file(folder / "metrics.jsonl"));
  std::string line;
  for (int run = 0; run < 2; ++run) {
    REQUIRE(std::getline(lines, line));
    const Json json = Json::parse(line);
    CHECK(json["step"] == run);
    CHECK(json["train/loss"] == 0.5 + run);
  }
}

TEST_CASE("going on from a step drops what was logged beyond it, here and in TensorBoard") {
  const lodestone::tests::TemporaryFolder folder;
  {
    MetricsLog log(folder.path());
    for (int step = 0; step < 4; ++step) log.write(step, {{"loss", 1.0}});
  }
  std::ofstream(folder / "metrics.jsonl", std::ios::app) << "{\"step\": 4, \"lo";  // cut off by a kill
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (entry.path().extension() == ".lodestone") std::filesystem::remove(entry);
  {
    MetricsLog log(folder.path(), 1, 100.0);
    log.write(2, {{"loss", 2.0}});
  }
  std::istringstream lines(read_file(folder / "metrics.jsonl"));
  std::vector<double> losses;
  double wall_s = 0.0;
  for (std::string line; std::getline(lines, line);) {
    losses.push_back(Json::parse(line).at("loss").get<double>());
    wall_s = Json::parse(line).at("wall_s").get<double>();
  }
  CHECK(losses == std::vector<double>{1.0, 1.0, 2.0});
  CHECK(wall_s >= 100.0);
  const Message start(event_records(folder.path()).at(1));
  CHECK(start.numbers.at(2) == 2);
  CHECK(Message(start.bytes.at(7)).numbers.at(1) == 1);
}

TEST_CASE("TensorBoard records are framed by length and checksum") {
  const lodestone::tests::TemporaryFolder folder;
  { TensorBoardWriter(folder.path()).write(3, {{"loss", 1.5}}); }
  const std::vector<std::string> records = event_records(folder.path());
  REQUIRE(records.size() == 2);
  CHECK(records[0].find("brain.Event:2") != std::string::npos);
  CHECK(records[1].find("loss") != std::string::npos);
  // The first record's length is 24, whose masked CRC-32C is fixed by the format.
  const auto entry = *std::filesystem::directory_iterator(folder.path());
  const std::string bytes = read_file(entry.path().string());
  const std::string length_bytes = bytes.substr(0, 8);
  CHECK(static_cast<unsigned char>(length_bytes[0]) == 24);
  std::uint32_t crc = 0;
  std::memcpy(&crc, bytes.data() + 8, 4);
  CHECK(crc == 0x224b7fa3U);
}

TEST_CASE("an image in the TensorBoard events reads back with its step, tag, size and bytes") {
  const lodestone::tests::TemporaryFolder folder;
  std::string png("\x89PNG\r\n\x1a\n");
  for (int i = 0; i < 1000; ++i) png.push_back(static_cast<char>(i));
  {
    MetricsLog log(folder.path());
    log.write_image(70000, "segmenter/frame", png, 640, 512);
    CHECK_THROWS_AS(log.write_image(1, "jpeg", "\xff\xd8\xff", 640, 512), LogicFault);
  }
  const std::vector<std::string> records = event_records(folder.path());
  REQUIRE(records.size() == 2);
  const Message event(records[1]);
  CHECK(event.numbers.at(2) == 70000);
  const Message value(Message(event.bytes.at(5)).bytes.at(1));
  CHECK(value.bytes.at(1) == "segmenter/frame");
  const Message image(value.bytes.at(4));
  CHECK(image.numbers.at(1) == 512);
  CHECK(image.numbers.at(2) == 640);
  CHECK(image.numbers.at(3) == 3);
  CHECK(image.bytes.at(4) == png);
}
