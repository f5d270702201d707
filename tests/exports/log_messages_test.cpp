#include "lodestone/exports/log_messages.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>

#include <catch2/catch.hpp>

#include "common/event_file.h"
#include "lodestone/common/error.h"

using namespace lodestone::exports;
using lodestone::tests::Message;

namespace {

double as_double(const std::string& bytes) {
  double value = 0.0;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

}  // namespace

TEST_CASE("an image is encoded by the numbers of Foxglove's schema") {
  const Message image(compressed_image_message(3'000'000'007, "camera", "jpeg bytes"));
  const Message stamp(image.bytes.at(1));
  CHECK(stamp.numbers.at(1) == 3);
  CHECK(stamp.numbers.at(2) == 7);
  CHECK(image.bytes.at(2) == "jpeg bytes");
  CHECK(image.bytes.at(3) == "jpeg");
  CHECK(image.bytes.at(4) == "camera");
}

TEST_CASE("a pose is a position and a turn about z") {
  const Message in_frame(pose_in_frame_message(0, "dish", {0.01, -0.02, 1.0}));
  CHECK(in_frame.bytes.at(2) == "dish");
  const Message pose(in_frame.bytes.at(3));
  const Message position(pose.bytes.at(1));
  CHECK(as_double(position.bytes.at(1)) == 0.01);
  CHECK(as_double(position.bytes.at(2)) == -0.02);
  const Message turned(pose.bytes.at(2));
  CHECK(as_double(turned.bytes.at(3)) == Approx(std::sin(0.5)));
  CHECK(as_double(turned.bytes.at(4)) == Approx(std::cos(0.5)));
}

TEST_CASE("a log entry has its level, and a frame its parent") {
  const Message entry(log_message(0, LogLevel::kError, "too warm"));
  CHECK(entry.numbers.at(2) == 4);
  CHECK(entry.bytes.at(3) == "too warm");
  const Message frame(frame_transform_message(0, "world", "dish", {}));
  CHECK(frame.bytes.at(2) == "world");
  CHECK(frame.bytes.at(3) == "dish");
}

TEST_CASE("what is not known is absent, and zero is not") {
  StepFacts facts;
  CHECK(Message(step_message(0, facts)).bytes.count(4) == 0);
  facts.error_m = 0.0;
  CHECK(as_double(Message(step_message(0, facts)).bytes.at(4)) == 0.0);
  const Message unknown(coil_status_message(0, {}));
  for (const int field : {2, 3, 4, 5}) CHECK(unknown.bytes.count(field) == 0);
  CoilReading reading;
  reading.temperature_C = OfCoils{1.0, 2.0, 3.0, 4.0};
  const Message warm(coil_status_message(0, reading));
  CHECK(as_double(Message(warm.bytes.at(3)).bytes.at(2)) == 2.0);
}

TEST_CASE("an action of two numbers has a field for each, and one of others is a list") {
  StepFacts facts;
  facts.action = {0.5, -0.25};
  const Message two(step_message(0, facts));
  CHECK(as_double(two.bytes.at(7)) == 0.5);
  CHECK(as_double(two.bytes.at(8)) == -0.25);
  CHECK(two.bytes.count(12) == 0);
  facts.action = {0.125, -0.25, 1.0};
  const Message three(step_message(0, facts));
  CHECK(three.bytes.count(7) == 0);
  REQUIRE(three.bytes.at(12).size() == 3 * sizeof(double));
  CHECK(as_double(three.bytes.at(12)) == 0.125);
}

TEST_CASE("a descriptor set is enough to decode its message") {
  google::protobuf::FileDescriptorSet files;
  REQUIRE(files.ParseFromString(file_descriptor_set("lodestone.CoilPulse")));
  google::protobuf::DescriptorPool pool;
  for (const auto& file : files.file()) REQUIRE(pool.BuildFile(file) != nullptr);
  const auto* type = pool.FindMessageTypeByName("lodestone.CoilPulse");
  REQUIRE(type != nullptr);
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<google::protobuf::Message> message(factory.GetPrototype(type)->New());
  REQUIRE(message->ParseFromString(coil_pulse_message(0, {1.0, 2.0, 3.0, 4.0})));
  CHECK(message->ShortDebugString() == "timestamp { } current_A { px: 1 mx: 2 py: 3 my: 4 }");
  CHECK_THROWS_AS(file_descriptor_set("foxglove.Nothing"), lodestone::common::LogicFault);
}
