#include "coils/coils.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <random>

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
