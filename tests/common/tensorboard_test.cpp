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

namespace {

/// The one value of the summary in an event.
Message value_of(const std::string& record) {
  return Message(Message(Message(record).bytes.at(5)).bytes.at(1));
}

/// Of a value that belongs to a plugin: its name, and what it keeps beside the tensor.
Message plugin_of(const Message& value) {
  const Message metadata(value.bytes.at(9));
  CHECK(metadata.numbers.at(4) == 2);  // DATA_CLASS_TENSOR
  return Message(metadata.bytes.at(1));
}

}  // namespace

TEST_CASE("text in the TensorBoard events is a tensor of the text page") {
  const lodestone::tests::TemporaryFolder folder;
  TensorBoardWriter(folder.path()).write_text(3, "config", "**seed** 7");
  const Message value = value_of(event_records(folder.path()).at(1));
  CHECK(value.bytes.at(1) == "config");
  CHECK(plugin_of(value).bytes.at(1) == "text");
  const Message tensor(value.bytes.at(8));
  CHECK(tensor.numbers.at(1) == 7);   // DT_STRING
  CHECK(tensor.bytes.at(2).empty());  // of no dimension
  CHECK(tensor.bytes.at(8) == "**seed** 7");
}

TEST_CASE("a session of the HParams page begins with its settings and ends with success") {
  const auto setting = [](const Json& value) {
    const lodestone::tests::TemporaryFolder folder;
    TensorBoardWriter writer(folder.path());
    writer.start_session({{"a.b", value}});
    writer.end_session();
    const std::vector<std::string> records = event_records(folder.path());
    const Message started = value_of(records.at(1));
    CHECK(started.bytes.at(1) == "_hparams_/session_start_info");
    CHECK(plugin_of(started).bytes.at(1) == "hparams");
    const Message start(Message(plugin_of(started).bytes.at(2)).bytes.at(3));
    const Message ended = value_of(records.at(2));
    CHECK(ended.bytes.at(1) == "_hparams_/session_end_info");
    const Message end(Message(plugin_of(ended).bytes.at(2)).bytes.at(4));
    CHECK(end.numbers.at(1) == 1);  // STATUS_SUCCESS
    CHECK(end.bytes.at(2).size() == sizeof(double));
    const Message entry(start.bytes.at(1));
    CHECK(entry.bytes.at(1) == "a.b");
    return Message(entry.bytes.at(2));
  };
  double number = 0.0;
  std::memcpy(&number, setting(2.5e-4).bytes.at(2).data(), sizeof number);
  CHECK(number == 2.5e-4);
  CHECK(setting("mlp").bytes.at(3) == "mlp");
  CHECK(setting(true).numbers.at(4) == 1);
  CHECK(setting(false).numbers.at(4) == 0);
  CHECK(setting({64, 32}).bytes.at(3) == "[64,32]");
}
