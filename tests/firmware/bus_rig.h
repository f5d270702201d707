#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "coils/coils.h"
#include "lodestone/emulation/roboclaw_model.h"

namespace lodestone::tests {

/// The controller's own code between a PC in the test's hands and two modelled motor controllers, which drive
/// coils (resistance and inductance only); the bus between them in the hands of whoever attacks it. Time is
/// the rig's.
class BusRig {
 public:
  static constexpr double kStep_s = 0.1e-3;

  enum class Way { kToControllers, kToFirmware };
  /// What becomes of a byte: the bytes that arrive in its place, each so much later. Called once per byte, in
  /// order.
  struct Arriving {
    std::uint8_t byte;
    double later_s = 0.0;
  };
  std::function<std::vector<Arriving>(Way way, std::int64_t index, std::uint8_t byte)> attack;

  ::Coils coils{};
  std::array<emulation::RoboClawModel, 2> controllers{emulation::RoboClawModel(0x80),
                                                      emulation::RoboClawModel(0x81)};
  std::array<double, 4> current_A{};
  bool open_switch = false;
  double now_s = 0.0;
  std::array<double, 4> stuck_duty{NAN, NAN, NAN, NAN};  ///< of an output that has failed; NaN: it obeys
  std::vector<wire::Message> replies;

  BusRig() {
    coils_init(&coils, {this, to_host, to_controllers}, 1, false);
    for (emulation::RoboClawModel& controller : controllers) controller.supply_V = kSupply_V;
  }

  double largest_A() const {
    double largest = 0.0;
    for (const double current : current_A) largest = std::max(largest, std::abs(current));
    return largest;
  }
  std::int64_t bytes(Way way) const { return count_[static_cast<std::size_t>(way)]; }

  /// A byte that nobody sent reaches the firmware so much later.
  void noise(std::uint8_t byte, double later_s) { noise_.push_back({byte, now_s + later_s}); }

  void step() {
    now_s += kStep_s;
    while (!noise_.empty() && noise_.front().time_s <= now_s) {
      coils_controller_byte(&coils, noise_.front().byte);
      noise_.pop_front();
    }
    deliver(to_controllers_, [this](std::uint8_t byte) {
      for (emulation::RoboClawModel& controller : controllers) controller.receive(byte, now_s);
    });
    std::uint8_t byte = 0;
    for (emulation::RoboClawModel& controller : controllers)
      while (controller.send(now_s, byte)) put(to_firmware_, Way::kToFirmware, byte);
    deliver(to_firmware_, [this](std::uint8_t arrived) { coils_controller_byte(&coils, arrived); });
    const bool closed = coils_contactor(&coils);
    for (std::size_t c = 0; c < 2; ++c) {
      emulation::RoboClawModel& controller = controllers[c];
      controller.supply_V = closed ? kSupply_V : 0.0;
      controller.advance(now_s);
      for (std::size_t i = 0; i < 2; ++i) {
        const double stuck = stuck_duty[2 * c + i];
        const double volt = (std::isnan(stuck) ? controller.duty()[i] : stuck) * controller.supply_V;
        double& amps = current_A[2 * c + i];
        amps += (volt - kResistance_ohm * amps) / kInductance_H * kStep_s;
        controller.current_A[i] = amps;
      }
    }
    coils_tick(&coils, static_cast<std::uint32_t>(std::llround(now_s * 1e6)), open_switch);
  }
  void run(double seconds) {
    for (const double end_s = now_s + seconds; now_s < end_s;) step();
  }
  /// One request to the firmware; its reply's type, or 0 for none.
  std::uint8_t ask(std::uint8_t type, const std::vector<std::uint8_t>& body = {}) {
    wire::Message message{};
    message.type = type;
    message.sequence = ++sequence_;
    message.length = static_cast<std::uint8_t>(body.size());
    std::copy(body.begin(), body.end(), message.body);
    std::uint8_t frame[wire::kMaxFrame];
    const int count = wire::encode_frame(&message, frame);
    replies.clear();
    for (int i = 0; i < count; ++i) coils_host_byte(&coils, frame[i]);
    return replies.empty() ? std::uint8_t{0} : replies.back().type;
  }
  void hello(std::uint8_t session) { ask(wire::kHello, {wire::kProtocolVersion, session, 2, 3, 4}); }
  void configure() {
    const wire::CoilLimits limits{15000, 2000,         1000, 10000, 200, 800, {1900, 1900, 1900, 1900},
                                  900,   {1, 0, 3, 2}, 1351};
    std::vector<std::uint8_t> body(wire::kCoilLimitsSize);
    wire::put_coil_limits(body.data(), &limits);
    ask(wire::kConfigure, body);
  }
  void connect() {
    hello(1);
    configure();
  }
  /// True when it was accepted.
  bool pulse(std::array<std::int16_t, 4> current_mA, std::uint16_t length_ms) {
    wire::PulseRequest request{};
    std::copy(current_mA.begin(), current_mA.end(), request.current_mA);
    request.length_ms = length_ms;
    std::vector<std::uint8_t> body(wire::kPulseRequestSize);
    wire::put_pulse_request(body.data(), &request);
    return ask(wire::kPulse, body) == (wire::kPulse | wire::kReply);
  }

 private:
  static constexpr double kSupply_V = 34.0;
  static constexpr double kResistance_ohm = 1.9;
  static constexpr double kInductance_H = 0.018;

  struct Timed {
    std::uint8_t byte;
    double time_s;
  };
  struct Line {
    std::deque<Timed> bytes;
    double free_s = 0.0;
  };

  void put(Line& line, Way way, std::uint8_t byte) {
    const std::int64_t index = count_[static_cast<std::size_t>(way)]++;
    line.free_s = std::max(line.free_s, now_s) + emulation::RoboClawModel::kByte_s;
    if (!attack) {
      line.bytes.push_back({byte, line.free_s});
      return;
    }
    for (const Arriving& arriving : attack(way, index, byte)) {
      line.free_s += arriving.later_s;  // a line keeps its order
      line.bytes.push_back({arriving.byte, line.free_s});
    }
  }
  template <typename F>
  void deliver(Line& line, F&& take) {
    while (!line.bytes.empty() && line.bytes.front().time_s <= now_s) {
      const std::uint8_t byte = line.bytes.front().byte;
      line.bytes.pop_front();
      take(byte);
    }
  }
  static void to_host(void* self, const std::uint8_t* bytes, std::uint8_t count) {
    auto& rig = *static_cast<BusRig*>(self);
    for (int i = 0; i < count; ++i) {
      wire::Message message{};
      if (wire::decode_byte(&rig.decoder_, bytes[i], &message)) rig.replies.push_back(message);
    }
  }
  static void to_controllers(void* self, const std::uint8_t* bytes, std::uint8_t count) {
    auto& rig = *static_cast<BusRig*>(self);
    for (int i = 0; i < count; ++i) rig.put(rig.to_controllers_, Way::kToControllers, bytes[i]);
  }

  wire::FrameDecoder decoder_{};
  std::uint16_t sequence_ = 0;
  std::array<std::int64_t, 2> count_{};
  Line to_controllers_;
  Line to_firmware_;
  std::deque<Timed> noise_;
};

}  // namespace lodestone::tests
