#include "coils/coils.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <vector>

using namespace lodestone;

namespace {

/// The controller's behaviour with both ends in the test's hands. Motor controllers answer at once, as asked.
struct Device {
  ::Coils coils{};
  std::vector<wire::Message> replies;
  wire::FrameDecoder decoder{};
  std::vector<std::vector<std::uint8_t>> packets;
  std::uint32_t now_us = 0;
  bool open_switch = false;
  bool answering = true;
  int duty[4] = {0, 0, 0, 0};
  int supply_dV = 340;
  int board_dC = 300;
  int drives = 0;

  Device() { coils_init(&coils, {this, to_host, to_controllers}, 1, false); }
  static void to_host(void* self, const std::uint8_t* bytes, std::uint8_t count) {
    auto& device = *static_cast<Device*>(self);
    for (int i = 0; i < count; ++i) {
      wire::Message message{};
      if (wire::decode_byte(&device.decoder, bytes[i], &message)) device.replies.push_back(message);
    }
  }
  static void to_controllers(void* self, const std::uint8_t* bytes, std::uint8_t count) {
    auto& device = *static_cast<Device*>(self);
    device.packets.emplace_back(bytes, bytes + count);
  }
  void answer() {
    std::vector<std::vector<std::uint8_t>> waiting;
    waiting.swap(packets);
    if (!answering) return;
    for (const std::vector<std::uint8_t>& request : waiting) answer(request);
  }
  void answer(const std::vector<std::uint8_t>& request) {
    const int first = 2 * (request[0] - kRoboClawAddress);
    std::vector<std::uint8_t> reply;
    const auto put = [&](int value) {
      reply.push_back(static_cast<std::uint8_t>(value >> 8));
      reply.push_back(static_cast<std::uint8_t>(value));
    };
    switch (request[1]) {
      case kReadSerialTimeout:
        reply = {2};
        break;
      case kReadMainBattery:
        put(supply_dV);
        break;
      case kReadCurrents:
        for (int i = 0; i < 2; ++i) put(duty[first + i] * 3400 / 32767 * 100 / 190);
        break;
      case kReadStatus:
        put(0);
        put(0);
        break;
      case kReadTemperature:
        put(board_dC);
        break;
      case kDriveDuty:
        ++drives;
        for (int i = 0; i < 2; ++i)
          duty[first + i] = static_cast<std::int16_t>(request[2 + 2 * i] << 8 | request[3 + 2 * i]);
        coils_controller_byte(&coils, 0xff);
        return;
      default:
        coils_controller_byte(&coils, 0xff);
        return;
    }
    std::uint16_t crc = 0;
    for (int i = 0; i < 2; ++i) crc = roboclaw_crc(crc, request[static_cast<std::size_t>(i)]);
    for (const std::uint8_t byte : reply) crc = roboclaw_crc(crc, byte);
    put(crc);
    for (const std::uint8_t byte : reply) coils_controller_byte(&coils, byte);
  }
  void run(double ms) {
    for (const std::uint32_t end = now_us + static_cast<std::uint32_t>(1000 * ms); now_us != end;
         now_us += 500) {
      coils_tick(&coils, now_us, open_switch);
      answer();
    }
  }
  wire::Message ask(std::uint8_t type, std::uint16_t sequence, const std::vector<std::uint8_t>& body = {}) {
    wire::Message message{};
    message.type = type;
    message.sequence = sequence;
    message.length = static_cast<std::uint8_t>(body.size());
    std::copy(body.begin(), body.end(), message.body);
    std::uint8_t frame[wire::kMaxFrame];
    const int count = wire::encode_frame(&message, frame);
    replies.clear();
    for (int i = 0; i < count; ++i) coils_host_byte(&coils, frame[i]);
    REQUIRE(replies.size() == 1);
    return replies.front();
  }
  void start(std::uint16_t sequence = 10) {
    CHECK(ask(wire::kHello, sequence, {wire::kProtocolVersion, 1, 2, 3, 4}).type ==
          (wire::kHello | wire::kReply));
    const wire::CoilLimits limits{15000, 2000, 1000, 10000, 200, 800, {1900, 1900, 1900, 1900}, 1351};
    std::vector<std::uint8_t> body(wire::kConfigureBody);
    wire::put_limits(body.data(), &limits);
    CHECK(ask(wire::kConfigure, static_cast<std::uint16_t>(sequence + 1), body).type ==
          (wire::kConfigure | wire::kReply));
    run(400);
  }
  static std::vector<std::uint8_t> pulse(int mA, int ms) {
    std::vector<std::uint8_t> body(wire::kPulseBody);
    std::uint8_t* at = wire::put_u16(body.data(), static_cast<std::uint16_t>(mA));
    for (int i = 0; i < 3; ++i) at = wire::put_u16(at, 0);
    wire::put_u16(at, static_cast<std::uint16_t>(ms));
    return body;
  }
  wire::CoilState state(std::uint16_t sequence) {
    wire::CoilState found{};
    const wire::Message reply = ask(wire::kStatus, sequence);
    REQUIRE(reply.length == wire::kStatusReplyBody);
    wire::get_state(reply.body, &found);
    return found;
  }
  bool on() const { return duty[0] != 0 || duty[1] != 0 || duty[2] != 0 || duty[3] != 0; }
};

std::uint8_t refusal(const wire::Message& message) {
  REQUIRE(message.type == wire::kRefused);
  return message.body[1];
}

}  // namespace

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

TEST_CASE("a pulse lasts as long as was asked, and a stop ends it at once") {
  Device device;
  device.start();
  device.ask(wire::kPulse, 12, Device::pulse(3000, 100));
  double on_ms = 0.0;
  for (int i = 0; i < 400; ++i) {
    device.run(0.5);
    on_ms += device.on() ? 0.5 : 0.0;
  }
  CHECK(on_ms == Approx(100.0).margin(1.0));
  device.ask(wire::kPulse, 13, Device::pulse(3000, 400));
  device.run(50);
  CHECK(device.on());
  device.ask(wire::kStop, 999);
  device.run(5);
  CHECK_FALSE(device.on());
}

TEST_CASE("limits are refused, faults latch and stay until cleared") {
  Device device;
  device.start();
  CHECK(refusal(device.ask(wire::kPulse, 12, Device::pulse(15001, 50))) == wire::kRefusedLimit);
  CHECK(refusal(device.ask(wire::kPulse, 13, Device::pulse(1000, 2001))) == wire::kRefusedLimit);
  CHECK(refusal(device.ask(wire::kPulse, 14, {1, 2, 3})) == wire::kRefusedBody);
  CHECK(refusal(device.ask(0x44, 15)) == wire::kRefusedBody);
  std::uint16_t sequence = 16;
  int fault = 0;
  SECTION("the PC falls silent") {
    device.ask(wire::kPulse, sequence++, Device::pulse(3000, 2000));
    device.run(490);
    CHECK(device.on());
    device.run(30);
    fault = wire::kFaultHostSilent;
  }
  SECTION("the emergency stop opens") {
    device.ask(wire::kPulse, sequence++, Device::pulse(3000, 400));
    device.open_switch = true;
    device.run(5);
    device.open_switch = false;
    fault = wire::kFaultEmergencyStop;
  }
  SECTION("the supply sags") {
    device.supply_dV = 120;
    device.run(300);
    device.supply_dV = 340;
    device.run(300);
    fault = wire::kFaultSupplyLow;
  }
  SECTION("a motor controller gets hot") {
    device.board_dC = 900;
    device.run(400);
    device.board_dC = 300;
    device.run(400);
    fault = wire::kFaultBoardHot;
  }
  CHECK_FALSE(device.on());
  CHECK((device.state(sequence++).faults & fault) != 0);
  CHECK(refusal(device.ask(wire::kPulse, sequence++, Device::pulse(1000, 50))) == wire::kRefusedFault);
  device.ask(wire::kClear, sequence++);
  device.run(400);
  CHECK(device.state(sequence++).faults == 0);
  CHECK(device.ask(wire::kPulse, sequence++, Device::pulse(1000, 50)).type == (wire::kPulse | wire::kReply));
}

TEST_CASE("a motor controller that does not answer latches a fault while the other is switched off") {
  Device device;
  device.start();
  device.ask(wire::kPulse, 12, Device::pulse(3000, 400));
  device.run(20);
  device.answering = false;
  device.run(120);
  device.answering = true;
  device.run(100);
  CHECK_FALSE(device.on());
  CHECK((device.state(13).faults & wire::kFaultControllerSilent) != 0);
}

TEST_CASE("time may wrap") {
  Device device;
  device.now_us = 0xffffffffu - 600000u - 350u;
  device.coils.tick_us = device.now_us;
  device.start();
  device.ask(wire::kPulse, 12, Device::pulse(3000, 300));
  device.run(100);
  CHECK(device.on());
  device.run(250);
  CHECK_FALSE(device.on());
  CHECK(device.state(13).faults == 0);
}

// Ten million inputs into the decoder and everything behind it.
TEST_CASE("the firmware takes ten million inputs of any kind, and none fires a pulse that nobody sent") {
  std::mt19937 random(3);
  Device device;
  device.start();
  for (int input = 0; input < 10000000; ++input) {
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
    }
  }
  CHECK(device.coils.pulses == 0);
  CHECK_FALSE(device.on());
}
