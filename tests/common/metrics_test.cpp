#include "lodestone/common/metrics.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "lodestone/common/config.h"
#include "lodestone/common/files.h"
#include "lodestone/common/tensorboard.h"
#include "temporary_folder.h"

using namespace lodestone::common;

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

TEST_CASE("TensorBoard records are framed by length and checksum") {
  const lodestone::tests::TemporaryFolder folder;
  { TensorBoardWriter(folder.path()).write(3, {{"loss", 1.5}}); }
  const auto entry = *std::filesystem::directory_iterator(folder.path());
  const std::string bytes = read_file(entry.path().string());
  std::vector<std::string> records;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at, 8);
    REQUIRE(at + 16 + length <= bytes.size());
    records.push_back(bytes.substr(at + 12, length));
    at += 16 + length;
  }
  REQUIRE(records.size() == 2);
  CHECK(records[0].find("brain.Event:2") != std::string::npos);
  CHECK(records[1].find("loss") != std::string::npos);
  // The first record's length is 24, whose masked CRC-32C is fixed by the format.
  const std::string length_bytes = bytes.substr(0, 8);
  CHECK(static_cast<unsigned char>(length_bytes[0]) == 24);
  std::uint32_t crc = 0;
  std::memcpy(&crc, bytes.data() + 8, 4);
  CHECK(crc == 0x224b7fa3U);
}
