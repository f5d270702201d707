#include "lodestone/emulation/roboclaw_model.h"

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {

/// CRC-16 as the manual prints it.
std::uint16_t crc16(const std::vector<std::uint8_t>& bytes) {
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 0x8000u) != 0 ? (crc << 1) ^ 0x1021 : crc << 1);
  }
  return crc;
}

std::vector<std::uint8_t> with_checksum(std::vector<std::uint8_t> packet) {
  const std::uint16_t crc = crc16(packet);
  packet.push_back(static_cast<std::uint8_t>(crc >> 8));
  packet.push_back(static_cast<std::uint8_t>(crc));
  return packet;
}

struct Line {
  emulation::RoboClawModel model{0x80};
  double now_s = 1.0;

  /// Bytes that came back within 20 ms.
  std::vector<std::uint8_t> ask(const std::vector<std::uint8_t>& packet) {
    for (const std::uint8_t byte : packet) model.receive(byte, now_s += 87e-6);
    std::vector<std::uint8_t> answer;
    std::uint8_t byte = 0;
    now_s += 0.02;
    while (model.send(now_s, byte)) answer.push_back(byte);
    return answer;
  }
  void wait(double time_s) { model.advance(now_s += time_s); }
};

const std::vector<std::uint8_t> kAcknowledged = {0xff};
// Duties 16384 and -16384 of 32767, for both outputs.
const std::vector<std::uint8_t> kHalf = {0x80, 34, 0x40, 0x00, 0xc0, 0x00};

}  // namespace

TEST_CASE("a controller that forgets its settings drives on, and no silence stops it") {
  Line line;
  CHECK(line.ask(with_checksum({0x80, 14, 2})) == kAcknowledged);  // 0.2 s
  CHECK(line.ask(with_checksum(kHalf)) == kAcknowledged);
  line.wait(0.1);
  line.model.forget_settings();
  line.wait(1.0);
  CHECK(line.model.duty()[0] == Approx(0.5).epsilon(1e-3));
  line.model.restart();
  line.wait(0.1);
  CHECK(line.model.duty()[0] == 0.0);
}

TEST_CASE("a duty is acknowledged and reached by its ramp") {
  Line line;
  CHECK(line.ask(with_checksum(kHalf)) == kAcknowledged);
  line.wait(0.1);
  CHECK(line.model.duty()[0] == Approx(0.5).epsilon(1e-3));
  CHECK(line.model.duty()[1] == Approx(-0.5).epsilon(1e-3));
  CHECK(line.ask(with_checksum({0x80, 68, 0x00, 0x00, 0x40, 0x00})) == kAcknowledged);  // 16384 counts/s
  CHECK(line.ask(with_checksum({0x80, 32, 0x00, 0x00})) == kAcknowledged);
  line.wait(0.5);
  CHECK(line.model.duty()[0] == Approx(0.24).margin(0.02));
}

TEST_CASE("a packet with a wrong checksum, for another address, or cut off does nothing") {
  Line line;
  auto wrong = with_checksum(kHalf);
  wrong.back() ^= 1;
  CHECK(line.ask(wrong).empty());
  auto other = kHalf;
  other[0] = 0x81;
  CHECK(line.ask(with_checksum(other)).empty());
  CHECK(line.ask({0x80, 34, 0x40}).empty());  // a gap follows
  line.wait(0.1);
  CHECK(line.model.duty()[0] == 0.0);
  CHECK(line.ask(with_checksum(kHalf)) == kAcknowledged);
}

TEST_CASE("readings answer with their value and a checksum over question and answer") {
  Line line;
  line.model.supply_V = 30.0;
  std::vector<std::uint8_t> expected = with_checksum({0x80, 24, 0x01, 0x2c});  // 300 tenths of a volt
  expected.erase(expected.begin(), expected.begin() + 2);
  CHECK(line.ask({0x80, 24}) == expected);
}

TEST_CASE("silence, the emergency stop and too much current switch the outputs off") {
  Line line;
  CHECK(line.ask(with_checksum({0x80, 14, 2})) == kAcknowledged);  // serial timeout 0.2 s
  CHECK(line.ask(with_checksum(kHalf)) == kAcknowledged);
  line.wait(0.1);
  CHECK(line.model.duty()[0] > 0.4);
  SECTION("silence") { line.wait(0.3); }
  SECTION("emergency stop") {
    line.model.emergency_stop = true;
    line.wait(0.01);
  }
  SECTION("current") {
    line.model.current_A = {61.0, 61.0};
    for (int i = 0; i < 5; ++i) line.wait(5e-3);
  }
  SECTION("no power") {
    line.model.powered = false;
    line.wait(0.01);
  }
  CHECK(line.model.duty()[0] == 0.0);
}
