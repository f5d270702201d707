#include "coils/coils.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <vector>

#include "device.h"
#include "soak.h"

using namespace lodestone;
using tests::Device;
using tests::refusal;

TEST_CASE("nothing is done before a session, and nothing twice within one") {
  Device device;
  CHECK(refusal(device.ask(wire::kPulse, 5, Device::pulse(1000, 50))) == wire::kRefusedSession);
  CHECK(refusal(device.ask(wire::kHello, 5, {99, 0, 0, 0, 0})) == wire::kRefusedVersion);
  device.start();
  const wire::Message first = device.ask(wire::kPulse, 12, Device::pulse(1000, 50));
  REQUIRE(first.type == (wire::kPulse | wire::kReply));
  device.run(20);
  CHECK(device.duty[0] > 1500);
  const wire::Message again = device.ask(wire::kPulse, 12, Device::pulse(1000, 50));
  CHECK(std::memcmp(&first, &again, 5) == 0);
  device.run(100);
  CHECK_FALSE(device.on());
  CHECK(device.ask(wire::kPulse, 12, Device::pulse(1000, 50)).type == (wire::kPulse | wire::kReply));
  device.run(20);
  CHECK_FALSE(device.on());
  CHECK(refusal(device.ask(wire::kPulse, 11, Device::pulse(1000, 50))) == wire::kRefusedSequence);
  CHECK(refusal(device.ask(wire::kPulse, 14, Device::pulse(1000, 50))) == wire::kRefusedSequence);
  CHECK(device.state(13).pulses == 1);
}

TEST_CASE(
    "the firmware says for how many motor controllers it was built, and takes bodies of no other number") {
  for (const int count : {1, 2, 8}) {
    CAPTURE(count);
    Device device(static_cast<std::uint8_t>(count));
    const wire::Message hello = device.ask(wire::kHello, 10, {wire::kProtocolVersion, 1, 2, 3, 4});
    REQUIRE(hello.length == wire::kHelloReplySize);
    wire::HelloReply answer{};
    wire::get_hello_reply(hello.body, &answer);
    CHECK(answer.version == 2);
    CHECK(answer.controllers == count);
    constexpr std::uint8_t kOther = 3;
    CHECK(refusal(device.ask(wire::kConfigure, 11, Device::limits(kOther))) == wire::kRefusedBody);
    CHECK_FALSE(device.coils.configured);
    device.start(20);
    CHECK(refusal(device.ask(wire::kPulse, 22, Device::pulse({1000}, 50, kOther))) == wire::kRefusedBody);
  }
}

TEST_CASE(
    "ranges are kept: each coil has its own largest currents, one sign, and coils it is never on with") {
  Device device(3);
  wire::CoilRanges ranges{};
  for (int i = 0; i < 6; ++i) ranges.largest_mA[i] = 15000;
  ranges.largest_mA[1] = 4000;
  ranges.smallest_mA[2] = -2000;
  ranges.not_with[0] = 1 << 3 | 1 << 5;
  std::vector<std::uint8_t> body(wire::coil_ranges_size(3));
  const auto ask_ranges = [&](std::uint16_t sequence) {
    wire::put_coil_ranges(body.data(), &ranges, 3);
    return device.ask(wire::kRanges, sequence, body);
  };
  device.ask(wire::kHello, 10, {wire::kProtocolVersion, 1, 2, 3, 4});
  CHECK(refusal(ask_ranges(11)) == wire::kRefusedSetup);  // CONFIGURE comes first
  device.start(20);
  CHECK(ask_ranges(22).type == (wire::kRanges | wire::kReply));
  device.run(400);
  const auto asked = [&](std::uint16_t sequence, const std::vector<int>& mA) {
    return device.ask(wire::kPulse, sequence, Device::pulse(mA, 20, 3));
  };
  CHECK(asked(23, {0, 4000, 0, 0, 0, 0}).type == (wire::kPulse | wire::kReply));
  const wire::Message beyond = asked(24, {0, 4001, 0, 0, 0, 0});
  CHECK(refusal(beyond) == wire::kRefusedLimit);
  CHECK((beyond.body[2] | beyond.body[3] << 8) == 4000);
  CHECK(refusal(asked(25, {-1, 0, 0, 0, 0, 0})) == wire::kRefusedLimit);
  CHECK(asked(26, {0, 0, -2000, 0, 0, 0}).type == (wire::kPulse | wire::kReply));
  CHECK(refusal(asked(27, {0, 0, -2001, 0, 0, 0})) == wire::kRefusedLimit);
  CHECK(refusal(asked(28, {1000, 0, 0, 0, 0, 1000})) == wire::kRefusedOpposite);
  CHECK(refusal(asked(29, {1000, 0, 0, 1000, 0, 0})) == wire::kRefusedOpposite);
  CHECK(asked(30, {1000, 1000, 0, 0, 0, 0}).type == (wire::kPulse | wire::kReply));  // no longer a pair
  ranges.largest_mA[4] = 15001;  // more than CONFIGURE has
  CHECK(refusal(ask_ranges(31)) == wire::kRefusedBody);
  ranges.largest_mA[4] = 15000;
  ranges.not_with[4] = 1 << 6;  // there is no such output
  CHECK(refusal(ask_ranges(32)) == wire::kRefusedBody);
  device.run(400);
  CHECK_FALSE(device.on());
  CHECK(device.state(33).faults == 0);
}

TEST_CASE("a coil is cut by its own largest current, not by that of the strongest") {
  Device device(1);
  device.start();
  wire::CoilRanges ranges{};
  ranges.largest_mA[0] = 2000;
  ranges.largest_mA[1] = 15000;
  std::vector<std::uint8_t> body(wire::coil_ranges_size(1));
  wire::put_coil_ranges(body.data(), &ranges, 1);
  device.ask(wire::kRanges, 12, body);
  device.run(400);
  CHECK(device.ask(wire::kPulse, 13, Device::pulse({2000, 0}, 300, 1)).type == (wire::kPulse | wire::kReply));
  device.run(30);
  CHECK(device.on());
  device.coils.duty[0] = 12000;  // as a mistake would: 6.5 A, which the limits of all would let pass
  device.run(30);
  CHECK_FALSE(device.on());
  CHECK((device.state(14).faults & wire::kFaultOverCurrent) != 0);
}

// Into the decoder and everything behind it.
TEST_CASE("the firmware takes millions of inputs of any kind, and none fires a pulse that nobody sent",
          "[soak]") {
  const tests::Soak soak("inputs of any kind into the firmware", 1000000, 20000000);
  std::mt19937 random(static_cast<unsigned>(soak.seed()));
  Device device;
  device.start();
  for (std::int64_t input = 0; input < soak.count(); ++input) {
    std::uint8_t bytes[32];
    std::size_t count = random() % 16;
    for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(random() & random());
    if (input % 5 == 0) {  // whole frames, but never a pulse
      wire::Message message{};
      message.type = static_cast<std::uint8_t>(random() % 12);
      if (message.type == wire::kPulse) message.type = wire::kPing;
      message.sequence = static_cast<std::uint16_t>(device.coils.sequence + random() % 3);
      message.length = static_cast<std::uint8_t>(random() % 12);
      for (int i = 0; i < message.length; ++i) message.body[i] = static_cast<std::uint8_t>(random());
      std::uint8_t frame[wire::kMaxFrame];
      count = std::min<std::size_t>(wire::encode_frame(&message, frame), sizeof bytes);
      std::copy(frame, frame + count, bytes);
    }
    for (std::size_t i = 0; i < count; ++i) coils_host_byte(&device.coils, bytes[i]);
    for (std::size_t i = 0; i < count % 4; ++i) coils_controller_byte(&device.coils, bytes[i]);
    if (input % 16 == 0) {
      device.now_us += 500;
      coils_tick(&device.coils, device.now_us, false);
      device.answer();
      device.replies.clear();
      device.sent.clear();
    }
  }
  CHECK(device.coils.pulses == 0);
  CHECK_FALSE(device.on());
}
