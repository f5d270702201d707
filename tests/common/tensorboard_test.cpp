#include "lodestone/common/tensorboard.h"

#include <catch2/catch.hpp>

#include "common/event_file.h"
#include "lodestone/common/error.h"
#include "lodestone/common/metrics.h"
#include "temporary_folder.h"

using namespace lodestone::common;
using lodestone::tests::event_records;
using lodestone::tests::Message;

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
