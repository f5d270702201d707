// As tests/firmware/fault_runs_test.cpp, with the firmware on the emulated microcontroller.
#include <catch2/catch.hpp>
#include <deque>

#include "firmware/faults.h"
#include "lodestone/emulation/emulated_bench.h"
#include "rig/described_rig.h"
#include "soak.h"

using namespace lodestone;

namespace {

/// An emulated bench in the shape of a BusRig.
class EmulatedFaultRig {
 public:
  using Way = tests::BusRig::Way;

  EmulatedFaultRig() : rig_(tests::described_rig(), 1), bench_(rig_), start_s_(bench_.now_s()) {
    const auto take = [this](Way way) {
      return [this, way](std::uint8_t& byte) {
        put(way, byte);
        return false;  // it arrives with step()
      };
    };
    bench_.to_controllers_filter = take(Way::kToControllers);
    bench_.from_controllers_filter = take(Way::kToFirmware);
    bench_.shunt = [this](std::size_t coil, double amps) { return shunt ? shunt(coil, amps) : amps; };
  }

  struct Controllers {
    emulation::EmulatedBench& bench;
    emulation::RoboClawModel& operator[](std::size_t i) { return bench.controller(static_cast<int>(i)); }
  };

  double now_s = 0.0;
  std::array<double, 4> current_A{};
  std::array<double, 4> impedance{1.0, 1.0, 1.0, 1.0};
  std::array<double, 4> stuck_duty{NAN, NAN, NAN, NAN};
  bool open_switch = false;
  bool welded = false;
  double supply_V = 34.0;
  double contactor_s = 10e-3;
  std::function<std::vector<tests::BusRig::Arriving>(Way, std::int64_t, std::uint8_t)> attack;
  std::function<double(std::size_t, double)> shunt;
  std::function<void()> watch;
  std::vector<wire::Message> replies;

  static std::vector<std::uint8_t> limits() { return tests::Device::limits(); }
  static std::vector<std::uint8_t> pulse_body(const std::vector<int>& current_mA, int length_ms) {
    return tests::Device::pulse(current_mA, length_ms, 2);
  }
  bool contactor() { return bench_.arduino().contactor(); }
  void reset_firmware() { hang(); }  // only its watchdog resets this one
  void hang() { bench_.arduino().hang(); }
  void wrap_clock(double) {}  // it counts from the chip's start: this one takes more than an hour
  void noise(std::uint8_t byte, double later_s) { noise_.push_back({byte, now_s + later_s}); }
  void from_host(std::uint8_t byte) { bench_.host_write(&byte, 1); }

  void run(double seconds) {
    for (const double end_s = now_s + seconds; now_s < end_s;) step();
  }
  void step() {
    put_faults();
    deliver(noise_, [this](std::uint8_t byte) { bench_.arduino().controller_byte(byte); });
    deliver(to_firmware_, [this](std::uint8_t byte) { bench_.arduino().controller_byte(byte); });
    deliver(to_controllers_, [this](std::uint8_t byte) {
      for (int i = 0; i < 2; ++i) bench_.controller(i).receive(byte, bench_.now_s());
    });
    bench_.advance_to(bench_.now_s() + tests::BusRig::kStep_s);
    now_s = bench_.now_s() - start_s_;
    const physics::PerCoil measured_A = bench_.current_A();
    std::copy_n(measured_A.begin(), current_A.size(), current_A.begin());
    std::uint8_t byte = 0;
    while (bench_.host_read(byte))
      for (const std::uint8_t arrived : attacked(Way::kToHost, byte)) {
        wire::Message message{};
        if (wire::decode_byte(&decoder_, arrived, &message)) replies.push_back(message);
      }
    if (watch) watch();
  }
  std::uint8_t ask(std::uint8_t type, const std::vector<std::uint8_t>& body = {}, bool again = false) {
    wire::Message message{};
    message.type = type;
    message.sequence = again ? sequence_ : ++sequence_;
    message.length = static_cast<std::uint8_t>(body.size());
    std::copy(body.begin(), body.end(), message.body);
    std::uint8_t frame[wire::kMaxFrame];
    const int count = wire::encode_frame(&message, frame);
    replies.clear();
    for (int i = 0; i < count; ++i)
      for (const std::uint8_t byte : attacked(Way::kFromHost, frame[i])) bench_.host_write(&byte, 1);
    for (const double end_s = now_s + 0.05; replies.empty() && now_s < end_s;) step();
    return replies.empty() ? std::uint8_t{0} : replies.back().type;
  }

 private:
  struct Timed {
    std::uint8_t byte;
    double time_s;
  };

  void put_faults() {
    bench_.set_supply_V(supply_V);
    bench_.weld_contactor(welded);
    bench_.set_contactor_s(contactor_s);
    for (std::size_t coil = 0; coil < 4; ++coil) {
      bench_.stick_driver(static_cast<int>(coil), stuck_duty[coil]);
      bench_.short_coil(static_cast<int>(coil), impedance[coil]);
    }
    if (open_switch != opened_) bench_.arduino().set_emergency_stop(open_switch);
    opened_ = open_switch;
  }
  std::vector<std::uint8_t> attacked(Way way, std::uint8_t byte) {
    if (!attack) return {byte};
    std::vector<std::uint8_t> bytes;
    for (const tests::BusRig::Arriving& arriving : attack(way, 0, byte)) bytes.push_back(arriving.byte);
    return bytes;
  }
  void put(Way way, std::uint8_t byte) {
    std::deque<Timed>& line = way == Way::kToControllers ? to_controllers_ : to_firmware_;
    if (!attack) {
      line.push_back({byte, now_s});
      return;
    }
    for (const tests::BusRig::Arriving& arriving : attack(way, 0, byte)) {
      const double before_s = line.empty() ? now_s : line.back().time_s;  // a line keeps its order
      line.push_back({arriving.byte, std::max(now_s, before_s) + arriving.later_s});
    }
  }
  template <typename F>
  void deliver(std::deque<Timed>& line, F&& take) {
    while (!line.empty() && line.front().time_s <= now_s) {
      const std::uint8_t byte = line.front().byte;
      line.pop_front();
      take(byte);
    }
  }

  rig::VirtualRig rig_;
  emulation::EmulatedBench bench_;
  double start_s_;
  bool opened_ = false;
  wire::FrameDecoder decoder_{};
  std::uint16_t sequence_ = 0;
  std::deque<Timed> noise_;
  std::deque<Timed> to_controllers_;
  std::deque<Timed> to_firmware_;

 public:
  Controllers controllers{bench_};
};

}  // namespace

TEST_CASE("no seeded run with one or two faults leaves a coil of the emulated bench on", "[soak]") {
  const tests::Soak soak("fault runs of the emulated microcontroller", 10, 1000);
  tests::check_fault_runs<EmulatedFaultRig>(soak.count(), soak.seed());
}
