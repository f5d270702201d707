#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <iterator>
#include <vector>

#include "coils/coils.h"

namespace lodestone::tests {

/// The controller's behaviour with both ends in the test's hands. Motor controllers answer at once, as asked.
struct Device {
  ::Coils coils{};
  std::vector<std::uint8_t> sent;  ///< to the PC, byte by byte
  std::vector<wire::Message> replies;
  wire::FrameDecoder decoder{};
  std::vector<std::vector<std::uint8_t>> packets;
  std::uint32_t now_us = 0;
  bool open_switch = false;
  bool answering = true;
  int duty[wire::kMostOutputs] = {};
  int supply_dV = 340;
  int board_dC = 300;
  int coil_10mohm = 190;  ///< of every coil
  int stray_10mA = 0;     ///< in every reading of a current, whatever the duty
  int drives = 0;

  explicit Device(std::uint8_t motor_controllers = 2) {
    coils_init(&coils, {this, to_host, to_controllers}, motor_controllers, 1, false);
  }
  static void to_host(void* self, const std::uint8_t* bytes, std::uint8_t count) {
    auto& device = *static_cast<Device*>(self);
    device.sent.insert(device.sent.end(), bytes, bytes + count);
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
        for (int i = 0; i < 2; ++i) put(duty[first + i] * 3400 / 32767 * 100 / coil_10mohm + stray_10mA);
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
  void run(double ms, std::uint32_t step_us = 500) {
    for (const std::uint32_t end = now_us + static_cast<std::uint32_t>(1000 * ms); now_us != end;
         now_us += step_us) {
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
    const std::vector<std::uint8_t> body = limits(coils.motor_controllers);
    CHECK(ask(wire::kConfigure, static_cast<std::uint16_t>(sequence + 1), body).type ==
          (wire::kConfigure | wire::kReply));
    run(400);
  }
  /// CONFIGURE: coils of 1.9 ohm, M1 and M2 of a motor controller never on together, 450 W for each of those.
  static std::vector<std::uint8_t> limits(std::uint8_t motor_controllers = 2) {
    wire::CoilLimits limits{15000, 2000, 1000, 10000, 200, 800, {}, 0, {}, 1351};
    limits.max_power_W = static_cast<std::uint16_t>(450 * motor_controllers);
    for (int i = 0; i < 2 * motor_controllers; ++i) {
      limits.resistance_mohm[i] = 1900;
      limits.opposite[i] = static_cast<std::uint8_t>(i ^ 1);
    }
    std::vector<std::uint8_t> body(wire::coil_limits_size(motor_controllers));
    wire::put_coil_limits(body.data(), &limits, motor_controllers);
    return body;
  }
  /// PULSE: these currents, and none in the outputs after them.
  static std::vector<std::uint8_t> pulse(const std::vector<int>& mA, int ms, std::uint8_t motor_controllers) {
    wire::PulseRequest request{};
    for (std::size_t i = 0; i < mA.size(); ++i) request.current_mA[i] = static_cast<std::int16_t>(mA[i]);
    request.length_ms = static_cast<std::uint16_t>(ms);
    std::vector<std::uint8_t> body(wire::pulse_request_size(motor_controllers));
    wire::put_pulse_request(body.data(), &request, motor_controllers);
    return body;
  }
  static std::vector<std::uint8_t> pulse(int mA, int ms) { return pulse({mA}, ms, 2); }
  wire::CoilState state(std::uint16_t sequence) {
    wire::CoilState found{};
    const wire::Message reply = ask(wire::kStatus, sequence);
    REQUIRE(reply.length == wire::coil_state_size(coils.motor_controllers));
    wire::get_coil_state(reply.body, &found, coils.motor_controllers);
    return found;
  }
  bool on() const {
    return std::any_of(std::begin(duty), std::end(duty), [](int each) { return each != 0; });
  }
};

inline std::uint8_t refusal(const wire::Message& message) {
  REQUIRE(message.type == wire::kRefused);
  return message.body[1];
}

}  // namespace lodestone::tests
