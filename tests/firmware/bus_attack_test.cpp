// Whatever happens to the bytes between the coil controller and the motor controllers, no coil stays on.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <string>
#include <vector>

#include "bus_rig.h"
#include "soak.h"

using namespace lodestone;
using tests::BusRig;

namespace {

constexpr double kOffWithin_s = 0.6;
constexpr double kOn_A = 0.05;

/// A session with pulses on either coil of either axis, whose ends fall at all phases of the bus; the last
/// one is cut by STOP or by the emergency switch. Returns how long current flowed that no pulse of the last
/// 0.6 s accounts for.
double unaccounted_s(BusRig& rig, double phase_s, bool by_switch) {
  double allowed_until_s = 0.0;
  double unaccounted_s = 0.0;
  const auto run = [&](double seconds) {
    for (const double end_s = rig.now_s + seconds; rig.now_s < end_s;) {
      rig.step();
      if (rig.largest_A() > kOn_A && rig.now_s > allowed_until_s) unaccounted_s += BusRig::kStep_s;
    }
  };
  rig.connect();
  run(0.4 + phase_s);
  const std::int16_t pulses[4][4] = {
      {5000, 0, 0, 4000}, {0, 6000, 2000, 0}, {-3000, 0, 0, 0}, {0, 5000, 0, -5000}};
  for (int i = 0; i < 4; ++i) {
    const bool last = i == 3;
    const std::uint16_t length_ms = last ? 400 : static_cast<std::uint16_t>(60 + 20 * i);
    const std::array<std::int16_t, 4> asked{pulses[i][0], pulses[i][1], pulses[i][2], pulses[i][3]};
    double on_s = 0.0;
    if (rig.pulse(asked, length_ms)) on_s = last ? 0.1 : 1e-3 * length_ms;
    allowed_until_s = std::max(allowed_until_s, rig.now_s + on_s + kOffWithin_s);
    run(0.1);
    if (last && by_switch) rig.open_switch = true;
    if (last && !by_switch) rig.ask(wire::kStop);
    run(0.08 + phase_s / 3.0);
  }
  run(1.2);
  return unaccounted_s;
}

enum class Attack { kDrop, kFlip, kForge, kDelay, kDropAndForge, kFlipAndForge, kCount };
const char* const kNames[] = {"dropped",           "flipped", "forged", "delayed", "dropped, then 0xff",
                              "flipped, then 0xff"};

/// Attacks one byte of one way; the pairs answer a damaged request with the noise of an acknowledgement.
void aim(BusRig& rig, Attack attack, BusRig::Way way, std::int64_t at, std::mt19937& random) {
  const auto bit = static_cast<std::uint8_t>(1U << (random() % 8));
  const double later_s = 1e-4 * static_cast<double>(1 + random() % 300);
  rig.attack = [=, &rig](BusRig::Way of, std::int64_t index,
                         std::uint8_t byte) -> std::vector<BusRig::Arriving> {
    if (of != way || index != at) return {{byte}};
    switch (attack) {
      case Attack::kDrop:
        return {};
      case Attack::kFlip:
        return {{static_cast<std::uint8_t>(byte ^ bit)}};
      case Attack::kForge:
        return {{byte}, {0xff}};
      case Attack::kDelay:
        return {{byte, later_s}};
      default:
        rig.noise(0xff, 1e-3 + later_s / 10.0);  // about when the acknowledgement is due
        break;
    }
    if (attack == Attack::kDropAndForge) return {};
    return {{static_cast<std::uint8_t>(byte ^ bit)}};
  };
}

}  // namespace

TEST_CASE("a bus that damages, forges or delays any one byte leaves no coil on", "[soak]") {
  BusRig healthy;
  REQUIRE(unaccounted_s(healthy, 0.0, false) == 0.0);
  CHECK(healthy.coils.faults == 0);
  const std::int64_t to_controllers = healthy.bytes(BusRig::Way::kToControllers);
  const std::int64_t to_firmware = healthy.bytes(BusRig::Way::kToFirmware);
  const std::int64_t whole = (to_controllers + to_firmware) * static_cast<std::int64_t>(Attack::kCount);
  const tests::Soak soak("attacks on single bytes of the motor controllers' bus", 600, whole);
  std::mt19937 random(static_cast<unsigned>(soak.seed()));
  for (std::int64_t i = 0; i < soak.count(); ++i) {
    const std::int64_t n =
        soak.count() == whole ? i : static_cast<std::int64_t>(random() % static_cast<unsigned>(whole));
    const auto attack = static_cast<Attack>(n % static_cast<std::int64_t>(Attack::kCount));
    const std::int64_t byte = n / static_cast<std::int64_t>(Attack::kCount);
    const bool forwards = byte < to_controllers;
    BusRig rig;
    aim(rig, attack, forwards ? BusRig::Way::kToControllers : BusRig::Way::kToFirmware,
        forwards ? byte : byte - to_controllers, random);
    const double phase_s = 1e-3 * static_cast<double>(random() % 25);
    const double left_s = unaccounted_s(rig, phase_s, random() % 2 == 0);
    CAPTURE(kNames[static_cast<int>(attack)], forwards, byte, phase_s, rig.coils.faults);
    REQUIRE(left_s == 0.0);
  }
}

TEST_CASE(
    "an output that sticks is cut off by the contactor, again after a CLEAR, and the firmware says why") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  rig.stuck_duty[1] = 0.3;
  rig.run(kOffWithin_s);
  CHECK(rig.largest_A() < kOn_A);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
  CHECK_FALSE(coils_contactor(&rig.coils));
  CHECK_FALSE(rig.pulse({1000, 0, 0, 0}, 50));
  rig.run(0.1);  // until the bus speaks again
  rig.ask(wire::kClear);
  rig.run(0.15);
  CHECK(rig.contactor());
  rig.run(kOffWithin_s);
  CHECK(rig.largest_A() < kOn_A);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
  rig.stuck_duty[1] = NAN;
  rig.ask(wire::kClear);
  rig.run(1.0);
  CHECK(rig.coils.faults == 0);
  CHECK(rig.pulse({1000, 0, 0, 0}, 50));
}

TEST_CASE("a contactor that a fault has opened does not keep a new session from being ready to CLEAR it") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  rig.stuck_duty[1] = 0.3;
  rig.run(1.0);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
  rig.stuck_duty[1] = NAN;
  rig.hello(2);
  rig.configure();
  rig.run(1.5);
  CHECK_FALSE(rig.contactor());
  rig.ask(wire::kStatus);
  CHECK((rig.replies.back().body[0] & wire::kStateReady) != 0);
  CHECK_FALSE(rig.pulse({5000, 0, 0, 0}, 100));
  CHECK(rig.replies.back().body[1] == wire::kRefusedFault);
  rig.ask(wire::kClear);
  rig.run(0.5);
  CHECK(rig.pulse({5000, 0, 0, 0}, 100));
}

TEST_CASE("an output that sticks is cut off although pulses of its coil go on") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  for (int i = 0; i < 3; ++i) {
    REQUIRE(rig.pulse({0, 5000, 0, 0}, 100));
    rig.run(0.25);
  }
  CHECK(rig.coils.faults == 0);
  REQUIRE(rig.pulse({0, 5000, 0, 0}, 100));
  rig.run(0.08);
  rig.stuck_duty[1] = 0.3;
  rig.run(0.17);
  for (int i = 0; i < 2; ++i) {
    rig.pulse({0, 5000, 0, 0}, 100);
    rig.run(0.25);
  }
  CHECK(rig.largest_A() < kOn_A);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
}

TEST_CASE("a CLEAR while nobody looks at the coils closes no contactor") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  rig.stuck_duty[1] = 0.3;
  rig.run(0.3);
  REQUIRE(rig.coils.quiet);
  rig.ask(wire::kClear);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
  rig.run(0.3);
  CHECK(rig.largest_A() < kOn_A);
  CHECK_FALSE(rig.contactor());
}

TEST_CASE("the contactor is closed only while the currents of all coils are known") {
  BusRig rig;
  rig.controllers[1].tx_open = true;
  rig.connect();
  rig.run(0.5);
  CHECK_FALSE(rig.contactor());
  CHECK(rig.coils.faults == 0);
  rig.controllers[1].tx_open = false;
  rig.run(0.3);
  CHECK(rig.contactor());
  rig.controllers[1].tx_open = true;
  rig.run(0.4);
  CHECK_FALSE(rig.contactor());
  CHECK((rig.coils.faults & wire::kFaultControllerSilent) != 0);
  rig.stuck_duty[2] = 0.3;  // which nobody could see
  rig.run(0.2);
  CHECK(rig.largest_A() < kOn_A);
  rig.stuck_duty[2] = NAN;
  rig.controllers[1].tx_open = false;
  rig.run(0.2);
  CHECK_FALSE(rig.contactor());
  rig.ask(wire::kClear);
  rig.run(0.5);
  CHECK(rig.coils.faults == 0);
  CHECK(rig.pulse({0, 0, 1000, 0}, 50));
}

TEST_CASE("duties that never arrive, each acknowledged by noise, end in silence on the bus and no current") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  REQUIRE(rig.pulse({5000, 0, 0, 0}, 100));
  rig.run(0.05);
  CHECK(rig.largest_A() > 1.0);
  std::vector<std::uint8_t> packet;
  double last_s = 0.0;
  rig.attack = [&](BusRig::Way way, std::int64_t, std::uint8_t byte) -> std::vector<BusRig::Arriving> {
    if (way != BusRig::Way::kToControllers) return {{byte}};
    if (rig.now_s - last_s > 0.5e-3) packet.clear();
    last_s = rig.now_s;
    packet.push_back(byte);
    if (packet.size() != 3 || packet[1] != kDriveDuty) return {{byte}};
    rig.noise(0xff, 2e-3);
    return {{static_cast<std::uint8_t>(byte ^ 0x40)}};
  };
  rig.run(0.05 + kOffWithin_s);
  CHECK(rig.largest_A() < kOn_A);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
}

TEST_CASE(
    "a pulse that a silent PC leaves behind is cut in time, although another fault has ended it before") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  REQUIRE(rig.pulse({5000, 0, 0, 0}, 2000));
  rig.run(0.35);
  CHECK(rig.largest_A() > 1.0);
  rig.attack = [](BusRig::Way way, std::int64_t, std::uint8_t byte) -> std::vector<BusRig::Arriving> {
    return {{static_cast<std::uint8_t>(way == BusRig::Way::kToControllers ? byte ^ 1 : byte)}};
  };
  const auto obey_late = [&] {  // what still comes through keeps the controller's own timeout from ending it
    const std::uint8_t packet[] = {0x80, 49};
    for (const std::uint8_t byte : packet) rig.controllers[0].receive(byte, rig.now_s);
  };
  while (rig.now_s < 0.4 + kOffWithin_s) {
    rig.run(0.02);
    obey_late();
  }
  CHECK((rig.coils.faults & wire::kFaultControllerSilent) != 0);
  CHECK((rig.coils.faults & wire::kFaultHostSilent) != 0);
  CHECK(rig.largest_A() < kOn_A);
}

TEST_CASE("a coil that a new session switches off is seen to be off before that session is configured") {
  BusRig rig;
  rig.connect();
  rig.run(0.4);
  REQUIRE(rig.pulse({5000, 0, 0, 0}, 400));
  rig.run(0.1);
  rig.hello(2);
  rig.run(1.0);
  CHECK(rig.largest_A() < kOn_A);
  rig.configure();
  rig.run(0.5);
  CHECK(rig.coils.faults == 0);
  CHECK(rig.pulse({1000, 0, 0, 0}, 50));
}

TEST_CASE("nothing moves before CONFIGURE; opposed coils and too much power are refused") {
  BusRig rig;
  CHECK_FALSE(coils_contactor(&rig.coils));
  rig.hello(1);
  rig.run(0.4);
  CHECK_FALSE(coils_contactor(&rig.coils));
  CHECK_FALSE(rig.pulse({1000, 0, 0, 0}, 50));
  rig.connect();
  rig.run(0.4);
  CHECK_FALSE(rig.pulse({1000, 1000, 0, 0}, 50));
  CHECK(rig.replies.back().body[1] == wire::kRefusedOpposite);
  CHECK(rig.pulse({15000, 0, 0, 15000}, 50));  // 855 W
  rig.run(0.3);
  rig.coils.limits.max_power_W = 800;
  CHECK_FALSE(rig.pulse({15000, 0, 0, 15000}, 50));
  CHECK(rig.replies.back().body[1] == wire::kRefusedPower);
  CHECK(rig.pulse({14000, 0, 0, 14000}, 50));
}

TEST_CASE("sixteen coils begin within a few milliseconds, and one whose output sticks is cut off in time") {
  BusRig rig(8);
  rig.connect();
  rig.run(1.0);
  REQUIRE(rig.contactor());
  std::vector<int> mA(16, 0);
  for (std::size_t c = 0; c < 8; ++c) mA[2 * c] = 4000;  // one coil of each
  const std::vector<std::uint8_t> body = tests::Device::pulse(mA, 200, 8);
  const double asked_s = rig.now_s;
  REQUIRE(rig.ask(wire::kPulse, body) == (wire::kPulse | wire::kReply));
  double first_s = 0.0;
  double last_s = 0.0;
  while (last_s == 0.0 && rig.now_s < asked_s + 0.1) {
    rig.step();
    const auto on = std::count_if(rig.current_A.begin(), rig.current_A.end(),
                                  [](double current) { return current > 0.05; });
    if (on > 0 && first_s == 0.0) first_s = rig.now_s;
    if (on == 8) last_s = rig.now_s;
  }
  REQUIRE(last_s > 0.0);
  CHECK(last_s - first_s < 8e-3);  // a command is 0.7 ms long
  rig.run(0.15);
  for (std::size_t c = 0; c < 8; ++c) CHECK(rig.current_A[2 * c] == Approx(4.0).epsilon(0.1));
  rig.run(0.4);
  CHECK(rig.largest_A() < kOn_A);
  CHECK(rig.coils.faults == 0);
  rig.stuck_duty[13] = 0.3;
  rig.run(kOffWithin_s);
  CHECK(rig.largest_A() < kOn_A);
  CHECK((rig.coils.faults & wire::kFaultStrayCurrent) != 0);
  CHECK_FALSE(rig.contactor());
}

TEST_CASE("of eight motor controllers, one that falls silent in a pulse ends it for all of them in time") {
  for (const std::size_t silent : {std::size_t{0}, std::size_t{5}, std::size_t{7}}) {
    CAPTURE(silent);
    BusRig rig(8);
    rig.connect();
    rig.run(1.0);
    std::vector<int> mA(16, 0);
    for (std::size_t c = 0; c < 8; ++c) mA[2 * c + 1] = 3000;
    REQUIRE(rig.ask(wire::kPulse, tests::Device::pulse(mA, 2000, 8)) == (wire::kPulse | wire::kReply));
    rig.run(0.1);
    CHECK(rig.largest_A() > 1.0);
    rig.controllers[silent].tx_open = true;
    rig.run(0.3);
    CHECK(rig.largest_A() < kOn_A);
    CHECK((rig.coils.faults & wire::kFaultControllerSilent) != 0);
    CHECK((rig.coils.faults & wire::kFaultHostSilent) == 0);  // not for want of the PC
  }
}
