#include "lodestone/emulation/emulated_bench.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <thread>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/emulation/lockstep_port.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/coil_measurement.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/rig/serial_coils.h"
#include "rig/coils_conformance.h"
#include "rig/described_rig.h"
#include "soak.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

struct Bench {
  explicit Bench(const rig::VirtualRigConfig& config = tests::described_rig()) : rig(config, 1), bench(rig) {
    serial.max_pulse_s = 2.0;
    coils = std::make_unique<rig::SerialCoils>(
        serial, rig.config().coils, [this] { return std::make_unique<emulation::LockstepPort>(bench); });
  }
  void wait(double time_s) { bench.advance_to(bench.now_s() + time_s); }

  rig::VirtualRig rig;
  emulation::EmulatedBench bench;
  rig::SerialConfig serial;
  std::unique_ptr<rig::SerialCoils> coils;
};

}  // namespace

TEST_CASE("serial coils keep the contract of Coils, through the real firmware") {
  Bench b;
  CHECK(b.coils->info().firmware == "1.2.1");
  tests::check_coils_conformance(*b.coils, b.bench.clock(), 15.0, 0.2);
}

TEST_CASE("the microcontroller ends the pulse by itself, after the time that was asked") {
  Bench b;
  double on_s = 0.0;
  double off_s = 0.0;
  b.bench.watch = [&](double now_s, const physics::PerCoil& current_A) {
    if (current_A[0] > 2.5 && on_s == 0.0) on_s = now_s;
    if (current_A[0] > 2.5) off_s = now_s;
  };
  const double asked_s = b.bench.now_s();
  b.coils->apply({{5.0, 0.0, 0.0, -2.0}, 0.1});
  CHECK(b.bench.now_s() - asked_s < 5e-3);  // there and back at 115,200 baud
  b.wait(0.3);
  CHECK(off_s - on_s == Approx(0.1).margin(3e-3));
  CHECK(b.coils->trace().coil == 0);
  CHECK(b.coils->trace().samples.size() > 6);
}

TEST_CASE("five amperes asked are five amperes given, on a hot coil and with a weak supply, too") {
  for (const double temperature_C : {22.0, 60.0, 85.0}) {
    for (const double supply_V : {34.0, 24.0}) {
      Bench b;
      for (int coil = 0; coil < 4; ++coil) b.bench.heat_coil(coil, temperature_C);
      b.bench.set_supply_V(supply_V);
      b.wait(0.5);
      double given_A = 0.0;
      for (int pulse = 0; pulse < 2; ++pulse) {  // the first one tells the resistance
        b.coils->apply({{0.0, 0.0, 5.0, 0.0}, 0.1});
        b.wait(0.099);
        given_A = b.bench.current_A()[2];
        b.wait(0.3);
      }
      CAPTURE(temperature_C, supply_V);
      CHECK(given_A == Approx(5.0).epsilon(0.02));
      CHECK(b.coils->status().temperature_C[2] == Approx(temperature_C).margin(4.0));
    }
  }
}

TEST_CASE("coils are measured through their pulses") {
  for (const double inductance_H : {17.6e-3, 30e-3}) {
    rig::VirtualRigConfig config = tests::described_rig();
    config.coils.resistance_20C_ohm.assign(4, 2.3);
    config.coils.inductance_H.assign(4, inductance_H);
    config.ambient_C = 20.0;
    Bench b(config);
    const rig::CoilMeasurement found =
        rig::measure_coil(*b.coils, *b.coils, 1, 4.0, 5, [&](double seconds) { b.wait(seconds); });
    CHECK(found.resistance_ohm == Approx(2.3).epsilon(0.01));
    CHECK(found.inductance_H() == Approx(inductance_H).epsilon(0.08));
    CHECK(found.rms_A < 0.1);
  }
}

TEST_CASE("an unplugged port throws, and the next call after plugging in connects anew") {
  Bench b;
  b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1});
  b.bench.set_plugged(false);
  CHECK_THROWS_WITH(b.coils->status(), Contains("has gone"));
  CHECK_THROWS_AS(b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  b.coils->stop();  // never throws
  b.bench.set_plugged(true);
  CHECK_NOTHROW(b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1}));
  CHECK(b.coils->connections() == 2);
}

TEST_CASE("a restarted firmware is noticed, says why, and stays off until cleared") {
  Bench b;
  b.bench.arduino().hang();
  b.wait(1.0);
  CHECK(b.bench.arduino().resets() == 1);
  CHECK_THROWS_WITH(b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1}), Contains("restarted"));
  CHECK_THROWS_WITH(b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1}), Contains("watchdog"));
  CHECK(b.coils->info().reset_cause == 8);
  b.coils->clear_faults();
  b.wait(0.5);
  CHECK_NOTHROW(b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1}));
}

TEST_CASE("a driver that does not switch off, and a coil that is not connected, are named") {
  Bench b;
  SECTION("a driver that sticks: all that is left is the supply") {
    b.bench.stick_driver(2, 0.1);
    b.wait(0.5);
    CHECK_THROWS_WITH(b.coils->apply({{1.0, 0.0, 0.0, 0.0}, 0.1}), Contains("cut its supply"));
  }
  SECTION("a broken wire") {
    b.bench.short_coil(1, 100.0);
    b.coils->apply({{0.0, 3.0, 0.0, 0.0}, 0.2});
    b.wait(0.3);
    CHECK_THROWS_WITH(b.coils->apply({{0.0, 3.0, 0.0, 0.0}, 0.2}), Contains("is it connected"));
  }
}

TEST_CASE("motor controllers without power are told apart from a missing coil controller") {
  rig::VirtualRig rig(tests::described_rig(), 1);
  emulation::EmulatedBench bench(rig);
  bench.controller(1).powered = false;
  rig::SerialConfig serial;
  const auto open = [&bench] { return std::make_unique<emulation::LockstepPort>(bench); };
  CHECK_THROWS_WITH(rig::SerialCoils(serial, rig.config().coils, open),
                    Contains("motor controllers do not answer"));
  bench.controller(1).powered = true;
  CHECK_NOTHROW(rig::SerialCoils(serial, rig.config().coils, open));
  bench.to_host_filter = [](std::uint8_t&) { return false; };
  CHECK_THROWS_WITH(rig::SerialCoils(serial, rig.config().coils, open), Contains("does not answer"));
}

TEST_CASE("polarity turns the wires round, and bad settings are refused") {
  Bench b;
  physics::CoilsDescription wired = b.rig.config().coils;
  wired.polarity = {-1, 1, 1, 1};
  rig::SerialCoils turned(b.serial, wired,
                          [&b] { return std::make_unique<emulation::LockstepPort>(b.bench); });
  turned.apply({{3.0, 0.0, 0.0, 0.0}, 0.1});
  b.wait(0.09);
  CHECK(b.bench.current_A()[0] == Approx(-3.0).epsilon(0.03));
  CHECK(turned.status().current_A[0] == Approx(3.0).epsilon(0.05));
  physics::CoilsDescription bad = wired;
  bad.polarity = {1, 1, 1};
  CHECK_THROWS_AS(bad.validate(), common::ConfigError);
  bad.polarity = {1, 0, 1, 1};
  CHECK_THROWS_AS(bad.validate(), common::ConfigError);
}

TEST_CASE("coils on other outputs get their own current, resistance and trace") {
  Bench b;
  b.serial.output = {3, 2, 1, 4};
  physics::CoilsDescription wired = b.rig.config().coils;
  wired.polarity = {1, 1, -1, 1};
  wired.resistance_20C_ohm = {1.9, 1.9, 2.5, 1.9};
  b.bench.short_coil(0, 2.5 / 1.9);  // what output 1 drives is the coil +y now
  rig::SerialCoils mapped(b.serial, wired,
                          [&b] { return std::make_unique<emulation::LockstepPort>(b.bench); });
  mapped.apply({{0.0, 1.0, 4.0, 0.0}, 0.3});
  b.wait(0.29);
  CHECK(b.bench.current_A()[0] == Approx(-4.0).epsilon(0.04));
  CHECK(b.bench.current_A()[1] == Approx(1.0).margin(0.06));
  CHECK(mapped.status().current_A[2] == Approx(4.0).epsilon(0.05));
  b.wait(0.3);
  CHECK(mapped.state().resistance_ohm[2] == Approx(2.5).epsilon(0.05));
  CHECK(mapped.trace().coil == 2);
  CHECK(mapped.trace().samples.back().second == Approx(4.0).epsilon(0.1));
  rig::SerialConfig bad = b.serial;
  bad.output = {1, 1, 3, 4};
  CHECK_THROWS_WITH(bad.validate(), Contains("each of the outputs"));
}

namespace {

/// A preset, as it is described.
rig::VirtualRigConfig preset_rig(const std::string& name) {
  const std::string file = LODESTONE_SOURCE_DIR "/configs/rigs/" + name + ".json";
  rig::VirtualRigConfig config = common::config_from_json<rig::RigConfig>(common::read_json_file(file), file);
  config.simulation.deviation = rig::DeviationWidth::kNone;
  return config;
}

}  // namespace

TEST_CASE("six and eight coils are driven through the firmware for three and four motor controllers") {
  for (const char* const name : {"six_planar", "eight_tilted"}) {
    CAPTURE(name);
    Bench b(preset_rig(name));
    const std::size_t count = b.rig.config().coils.count();
    CHECK(b.bench.controllers() == count / 2);
    CHECK(b.coils->info().motor_controllers == static_cast<int>(count / 2));
    CHECK(b.coils->state().supply_V.size() == count / 2);
    b.wait(0.3);
    for (std::size_t coil = 0; coil < count; ++coil) {  // with the one across from it, half as much
      const std::size_t other = (coil + count / 2) % count;
      rig::CoilPulse pulse;
      pulse.current_A[coil] = 4.0;
      pulse.current_A[other] = 2.0;
      pulse.duration_s = 0.15;
      b.coils->apply(pulse);
      b.wait(0.13);
      const physics::PerCoil given_A = b.bench.current_A();
      for (std::size_t i = 0; i < count; ++i) {
        CAPTURE(coil, i);
        CHECK(given_A[i] == Approx(i == coil ? 4.0 : i == other ? 2.0 : 0.0).margin(0.1));
      }
      CHECK(b.coils->status().current_A[coil] == Approx(4.0).margin(0.2));
      b.wait(0.3);
      CHECK(std::abs(b.bench.current_A()[coil]) < 0.05);
    }
    CHECK(b.coils->status().faults.empty());
    CHECK_THROWS_WITH(b.coils->apply({physics::PerCoil(count, -1.0), 0.1}), Contains("is refused"));
    b.coils->apply({physics::PerCoil(count, 3.0), 2.0});
    b.wait(0.2);
    CHECK(b.bench.current_A()[count - 1] == Approx(3.0).margin(0.15));
    b.wait(0.8);  // and the PC says nothing
    for (std::size_t i = 0; i < count; ++i) CHECK(std::abs(b.bench.current_A()[i]) < 0.05);
    CHECK_FALSE(b.bench.arduino().contactor());
    CHECK_FALSE(b.coils->status().faults.empty());
  }
}

TEST_CASE("a driver that sticks is cut off on the last of four motor controllers, too") {
  Bench b(preset_rig("eight_tilted"));
  b.wait(0.3);
  b.bench.stick_driver(7, 0.1);
  b.wait(0.6);
  CHECK(std::abs(b.bench.current_A()[7]) < 0.05);
  CHECK_THROWS_WITH(b.coils->apply({{1.0}, 0.1}), Contains("cut its supply"));
}

TEST_CASE("a rig of other coils than the firmware is for is refused in one line") {
  Bench b(preset_rig("six_planar"));
  CHECK_THROWS_WITH(
      rig::SerialCoils(b.serial, physics::CoilsDescription{},
                       [&b] { return std::make_unique<emulation::LockstepPort>(b.bench); }),
      Contains("for 3 motor controllers (6 outputs), the rig's 4 coils") && Contains("flash coils-2.hex"));
}

TEST_CASE("an odd coil leaves the last output of the bench free") {
  rig::VirtualRigConfig config = preset_rig("six_planar");
  config.coils.each.pop_back();
  config.coils.resistance_20C_ohm.pop_back();
  config.coils.inductance_H.pop_back();
  config.coils.polarity.pop_back();
  Bench b(config);
  CHECK(b.bench.controllers() == 3);
  b.coils->apply({{0.0, 0.0, 0.0, 1.0, 3.0}, 0.15});
  b.wait(0.13);
  CHECK(b.bench.current_A()[4] == Approx(3.0).margin(0.1));
  b.wait(0.3);
  CHECK(b.coils->status().faults.empty());
}

// The loop sleeps on the bench's clock and pulses, another thread watches, and a third one stops: one port,
// one bench.
TEST_CASE("an emulated bench may be watched and stopped from any thread") {
  Bench b;
  std::atomic<bool> over{false};
  std::atomic<int> pulses{0};
  std::thread driver([&] {
    while (!over) {
      try {
        b.coils->apply({{3.0, 0.0, 0.0, 0.0}, 0.5});
        ++pulses;
      } catch (
          const common::HardwareError&) {  // given up for a stop, or refused for a fault: both are the point
      }
      b.wait(0.02);
    }
  });
  std::atomic<bool> answered{true};
  std::thread watcher([&] {
    try {
      while (!over) b.coils->status();
    } catch (const common::HardwareError&) {
      answered = false;
    }
  });
  while (pulses < 3) std::this_thread::yield();
  for (int stop = 0; stop < 3; ++stop) b.coils->stop();
  over = true;
  driver.join();
  watcher.join();
  CHECK(answered);
  b.coils->stop();
  b.wait(0.2);
  CHECK(std::abs(b.bench.current_A()[0]) < 0.1);
}

// As tests/firmware/bus_attack_test.cpp, with the firmware on the microcontroller.
TEST_CASE("no byte on the motor controllers' bus, damaged or forged, leaves a coil on", "[soak]") {
  const tests::Soak soak("attacks on the bus of the emulated microcontroller", 20, 1000);
  std::mt19937 random(static_cast<unsigned>(soak.seed()));
  for (std::int64_t run = 0; run < soak.count(); ++run) {
    Bench b;
    const int kind = static_cast<int>(random() % 3);
    const bool forwards = random() % 2 == 0;
    const auto at = static_cast<int>(random() % 400);  // about as many as pass each way
    const auto bit = static_cast<std::uint8_t>(1U << random() % 8);
    int count = 0;
    const auto attack = [&](std::uint8_t& byte) {
      if (count++ != at) return true;
      byte = kind == 1 ? static_cast<std::uint8_t>(byte ^ bit) : std::uint8_t{0xff};
      if (forwards) b.bench.arduino().controller_byte(0xff);  // what noise makes of a damaged request
      return kind != 0;
    };
    (forwards ? b.bench.to_controllers_filter : b.bench.from_controllers_filter) = attack;
    double end_s = b.bench.now_s();
    double late_A = 0.0;
    b.bench.watch = [&](double now_s, const physics::PerCoil& current_A) {
      for (const double current : current_A)
        if (now_s > end_s + 0.6) late_A = std::max(late_A, std::abs(current));
    };
    for (const rig::CoilPulse& pulse :
         {rig::CoilPulse{{5.0, 0.0, 0.0, 4.0}, 0.06}, rig::CoilPulse{{0.0, 6.0, 2.0, 0.0}, 0.4}}) {
      try {
        end_s = b.bench.now_s() + 0.1 + pulse.duration_s;
        b.coils->apply(pulse);
        b.wait(0.1 + 1e-3 * static_cast<double>(random() % 25));
      } catch (const common::HardwareError&) {  // refused for a fault: nothing may be on
      }
    }
    end_s = b.bench.now_s();
    b.coils->stop();
    b.wait(1.0);
    CAPTURE(kind, forwards, at, count);
    CHECK(late_A < 0.05);
  }
}

TEST_CASE("a pulse of 100 ms shows a hot coil to the real firmware, the strongest one, too") {
  for (const double current_A : {8.0, 15.0}) {
    Bench b;
    b.coils->status();
    b.bench.heat_coil(0, 160.0);
    b.coils->apply({{current_A, 0.0, 0.0, 0.0}, 0.1});
    b.wait(0.3);
    const std::vector<std::string> faults = b.coils->state().faults;
    CAPTURE(current_A, faults);
    REQUIRE(faults.size() == 1);
    CHECK_THAT(faults[0], Contains("hot"));
  }
}
