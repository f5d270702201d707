#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "coils/coils.h"
#include "device.h"
#include "lodestone/emulation/roboclaw_model.h"

namespace lodestone::tests {

/// The controller's own code between a PC in the test's hands and modelled motor controllers (two, as in the
/// paper's rig, or so many), which drive coils (resistance and inductance only) through a contactor; what
/// goes over the wires in the hands of whoever attacks it. Time is the rig's.
class BusRig {
 public:
  static constexpr double kStep_s = 0.1e-3;

  enum class Way { kToControllers, kToFirmware, kFromHost, kToHost };
  /// What becomes of a byte: the bytes that arrive in its place, each so much later (those from and to the
  /// host arrive at once). Called once per byte, in order.
  struct Arriving {
    std::uint8_t byte;
    double later_s = 0.0;
  };
  std::function<std::vector<Arriving>(Way way, std::int64_t index, std::uint8_t byte)> attack;

  ::Coils coils{};
  std::vector<emulation::RoboClawModel> controllers;
  std::vector<double> current_A;
  std::vector<double> impedance;  ///< of a coil, as a fraction of what it was wound with
  bool open_switch = false;
  double now_s = 0.0;
  double supply_V = kSupply_V;
  double contactor_s = 10e-3;      ///< until it has opened or closed
  bool welded = false;             ///< its contacts no longer open
  std::vector<double> stuck_duty;  ///< of an output that has failed; NaN: it obeys
  /// What the shunt of a coil tells instead of its current.
  std::function<double(std::size_t coil, double amps)> shunt;
  std::vector<wire::Message> replies;
  std::function<void()> watch;  ///< looks on after every step

  explicit BusRig(std::uint8_t motor_controllers = 2)
      : current_A(2 * std::size_t{motor_controllers}, 0.0),
        impedance(2 * std::size_t{motor_controllers}, 1.0),
        stuck_duty(2 * std::size_t{motor_controllers}, NAN) {
    for (std::uint8_t c = 0; c < motor_controllers; ++c)
      controllers.emplace_back(static_cast<std::uint8_t>(kRoboClawAddress + c));
    start_firmware(false);
  }
  BusRig(const BusRig&) = delete;  // the firmware holds its address
  BusRig& operator=(const BusRig&) = delete;

  /// As after a reset: it knows nothing, and its clock (of 32 bits) begins at this.
  void start_firmware(bool by_watchdog, std::uint32_t clock_us = 0) {
    coils_init(&coils, {this, to_host, to_controllers}, how_many(), by_watchdog ? 8 : 1, by_watchdog);
    coils.tick_us = clock_us;
    clock_us_ = clock_us;
    started_s_ = now_s;
    hung_ = false;
  }
  void reset_firmware() { start_firmware(true); }
  /// The firmware's loop stands still until the watchdog strikes.
  void hang() {
    hung_ = true;
    hung_s_ = now_s;
  }
  /// To be called at the start: the firmware's clock will go round then.
  void wrap_clock(double at_s) { start_firmware(false, 0u - static_cast<std::uint32_t>(1e6 * at_s)); }

  double largest_A() const {
    double largest = 0.0;
    for (const double current : current_A) largest = std::max(largest, std::abs(current));
    return largest;
  }
  bool contactor() const { return coils_contactor(&coils); }
  std::int64_t bytes(Way way) const { return count_[static_cast<std::size_t>(way)]; }

  /// A byte that nobody sent reaches the firmware so much later.
  void noise(std::uint8_t byte, double later_s) { noise_.push_back({byte, now_s + later_s}); }

  void step() {
    now_s += kStep_s;
    while (!noise_.empty() && noise_.front().time_s <= now_s) {
      to_firmware(noise_.front().byte);
      noise_.pop_front();
    }
    deliver(to_controllers_, [this](std::uint8_t byte) {
      for (emulation::RoboClawModel& controller : controllers) controller.receive(byte, now_s);
    });
    std::uint8_t byte = 0;
    for (emulation::RoboClawModel& controller : controllers)
      while (controller.send(now_s, byte)) put(to_firmware_, Way::kToFirmware, byte);
    deliver(to_firmware_, [this](std::uint8_t arrived) { to_firmware(arrived); });
    switch_supply();
    drive_coils();
    if (hung_ && now_s - hung_s_ > kWatchdog_s) reset_firmware();
    const auto firmware_us = static_cast<std::uint32_t>(std::llround((now_s - started_s_) * 1e6));
    if (!hung_) coils_tick(&coils, clock_us_ + firmware_us, open_switch);
    if (watch) watch();
  }
  void run(double seconds) {
    for (const double end_s = now_s + seconds; now_s < end_s;) step();
  }
  /// One request to the firmware; its reply's type, or 0 for none. `again`: the one before, repeated.
  std::uint8_t ask(std::uint8_t type, const std::vector<std::uint8_t>& body = {}, bool again = false) {
    wire::Message message{};
    message.type = type;
    if (!again) ++sequence_;
    message.sequence = sequence_;
    message.length = static_cast<std::uint8_t>(body.size());
    std::copy(body.begin(), body.end(), message.body);
    std::uint8_t frame[wire::kMaxFrame];
    const int count = wire::encode_frame(&message, frame);
    replies.clear();
    for (int i = 0; i < count; ++i)
      pass(Way::kFromHost, frame[i], [this](std::uint8_t byte) { from_host(byte); });
    return replies.empty() ? std::uint8_t{0} : replies.back().type;
  }
  /// A byte from the host's side, as it is.
  void from_host(std::uint8_t byte) {
    if (!hung_) coils_host_byte(&coils, byte);
  }
  void hello(std::uint8_t session) { ask(wire::kHello, {wire::kProtocolVersion, session, 2, 3, 4}); }
  std::vector<std::uint8_t> limits() const { return Device::limits(how_many()); }
  void configure() { ask(wire::kConfigure, limits()); }
  void connect() {
    hello(1);
    configure();
  }
  /// True when it was accepted. The outputs after the first four have none.
  bool pulse(std::array<std::int16_t, 4> current_mA, std::uint16_t length_ms) {
    return ask(wire::kPulse, pulse_body({current_mA.begin(), current_mA.end()}, length_ms)) ==
           (wire::kPulse | wire::kReply);
  }
  std::vector<std::uint8_t> pulse_body(const std::vector<int>& current_mA, int length_ms) const {
    return Device::pulse(current_mA, length_ms, how_many());
  }

 private:
  static constexpr double kSupply_V = 34.0;
  static constexpr double kWatchdog_s = 0.25;
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

  std::uint8_t how_many() const { return static_cast<std::uint8_t>(controllers.size()); }
  void to_firmware(std::uint8_t byte) {
    if (!hung_) coils_controller_byte(&coils, byte);
  }
  void switch_supply() {
    const bool told = coils_contactor(&coils);
    if (told == closed_) switched_s_ = now_s;
    if (now_s - switched_s_ >= contactor_s) closed_ = told;
    for (emulation::RoboClawModel& controller : controllers)
      controller.supply_V = closed_ || welded ? supply_V : 0.0;
  }
  void drive_coils() {
    for (std::size_t c = 0; c < controllers.size(); ++c) {
      emulation::RoboClawModel& controller = controllers[c];
      controller.advance(now_s);
      const std::array<double, 2> duty = controller.duty();
      for (std::size_t i = 0; i < 2; ++i) {
        const std::size_t coil = 2 * c + i;
        const double volt = (std::isnan(stuck_duty[coil]) ? duty[i] : stuck_duty[coil]) * controller.supply_V;
        double& amps = current_A[coil];
        amps += (volt / impedance[coil] - kResistance_ohm * amps) / kInductance_H * kStep_s;
        controller.current_A[i] = shunt ? shunt(coil, amps) : amps;
      }
    }
  }
  template <typename F>
  void pass(Way way, std::uint8_t byte, F&& take) {
    const std::int64_t index = count_[static_cast<std::size_t>(way)]++;
    if (!attack)
      take(byte);
    else
      for (const Arriving& arriving : attack(way, index, byte)) take(arriving.byte);
  }
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
    for (int i = 0; i < count; ++i)
      rig.pass(Way::kToHost, bytes[i], [&rig](std::uint8_t byte) {
        wire::Message message{};
        if (wire::decode_byte(&rig.decoder_, byte, &message)) rig.replies.push_back(message);
      });
  }
  static void to_controllers(void* self, const std::uint8_t* bytes, std::uint8_t count) {
    auto& rig = *static_cast<BusRig*>(self);
    for (int i = 0; i < count; ++i) rig.put(rig.to_controllers_, Way::kToControllers, bytes[i]);
  }

  wire::FrameDecoder decoder_{};
  std::uint16_t sequence_ = 0;
  std::array<std::int64_t, 4> count_{};
  std::uint32_t clock_us_ = 0;  ///< of the firmware's clock when it started
  double started_s_ = 0.0;
  bool hung_ = false;
  double hung_s_ = 0.0;
  bool closed_ = false;      ///< the contactor
  double switched_s_ = 0.0;  ///< when it was last told what it does already
  Line to_controllers_;
  Line to_firmware_;
  std::deque<Timed> noise_;
};

}  // namespace lodestone::tests
