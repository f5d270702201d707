#include "lodestone/rig/serial_coils.h"

#include <catch2/catch.hpp>

#include "rig/coils_conformance.h"
#include "rig/firmware_port.h"
#include "rig/ring_of_coils.h"

using namespace lodestone;
using tests::FirmwareBench;
using tests::FirmwarePort;

namespace {

/// The firmware's time, which the test moves while the PC is not waiting for an answer.
class FirmwareClock final : public common::Clock {
 public:
  explicit FirmwareClock(FirmwareBench& bench) : bench_(bench) {}
  double now_s() const override { return 1e-6 * bench_.device.now_us; }
  bool wait_until(double time_s, common::Interruption*) override {
    if (time_s > now_s()) bench_.device.run(std::ceil(2e3 * (time_s - now_s())) / 2.0);
    return true;
  }

 private:
  FirmwareBench& bench_;
};

}  // namespace

TEST_CASE("serial coils keep the contract of Coils, through the firmware's own code") {
  auto bench = std::make_shared<FirmwareBench>();
  rig::SerialConfig config;
  physics::CoilsDescription wired;
  config.max_pulse_s = 2.0;
  rig::SerialCoils coils(config, wired, [bench] { return std::make_unique<FirmwarePort>(bench); });
  FirmwareClock clock(*bench);
  tests::check_coils_conformance(coils, clock, 15.0, 0.2);
}

TEST_CASE("temperatures are what the resistances tell, and the trace is of the strongest coil") {
  auto bench = std::make_shared<FirmwareBench>();
  rig::SerialConfig config;
  physics::CoilsDescription wired;
  wired.resistance_20C_ohm = {1.8, 1.9, 1.9, 1.9};  // the fake controllers behave like 1.9 ohm
  rig::SerialCoils coils(config, wired, [bench] { return std::make_unique<FirmwarePort>(bench); });
  coils.apply({{5.0, 0.0, 2.0, 0.0}, 0.3});
  bench->device.run(320);
  CHECK(coils.status().temperature_C[0] == Approx(20.0 + (1.9 / 1.8 - 1.0) / 3.9e-3).margin(1.5));
  CHECK(coils.status().temperature_C[1] == Approx(20.0));
  const rig::CurrentTrace trace = coils.trace();
  CHECK(trace.coil == 0);
  CHECK(trace.samples.size() == wire::kTraceSamples);
  CHECK(coils.state().pulses == 1);
}

TEST_CASE("one, six, eight and sixteen coils are driven each by its own number, and measured") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{6}, std::size_t{8}, std::size_t{16}}) {
    CAPTURE(count);
    auto bench = std::make_shared<FirmwareBench>(static_cast<std::uint8_t>((count + 1) / 2));
    const physics::CoilsDescription ring = tests::ring_of(count);
    const rig::SerialConfig config;
    rig::SerialCoils coils(config, ring, [bench] { return std::make_unique<FirmwarePort>(bench); });
    CHECK(coils.info().motor_controllers == static_cast<int>((count + 1) / 2));
    for (std::size_t coil = 0; coil < count; ++coil) {
      rig::CoilPulse pulse;
      pulse.current_A[coil] = 2.0;
      pulse.duration_s = 0.1;
      coils.apply(pulse);
      bench->device.run(60);
      const rig::CoilStatus status = coils.status();
      CHECK(status.faults.empty());
      CHECK(status.current_A.size() == count);
      for (std::size_t other = 0; other < count; ++other)
        CHECK(status.current_A[other] == Approx(other == coil ? 2.0 : 0.0).margin(0.1));
      CHECK(coils.trace().coil == static_cast<int>(coil));
      bench->device.run(200);
      CHECK_FALSE(bench->device.on());
    }
    CHECK(coils.state().supply_V.size() == (count + 1) / 2);
    rig::CoilPulse negative{physics::PerCoil(count, -1.0), 0.1};
    CHECK_THROWS_AS(coils.apply(negative), common::HardwareError);  // they are unipolar
  }
}

TEST_CASE("coils without an output each, and outputs named twice, are refused in one line") {
  auto bench = std::make_shared<FirmwareBench>(std::uint8_t{3});
  const auto open = [bench] { return std::make_unique<FirmwarePort>(bench); };
  rig::SerialConfig config;
  config.output = {1, 2, 3, 4};
  CHECK_THROWS_WITH(rig::SerialCoils(config, tests::ring_of(6), open),
                    Catch::Contains("rig.serial.output names 4 outputs, the rig has 6 coils"));
  config.output = {1, 2, 3, 4, 5, 5};
  CHECK_THROWS_AS(rig::SerialCoils(config, tests::ring_of(6), open), common::ConfigError);
  config.output = {1, 2, 3, 4, 5, 17};
  CHECK_THROWS_AS(rig::SerialCoils(config, tests::ring_of(6), open), common::ConfigError);
  CHECK(bench->opened == 0);
}

TEST_CASE("resistances that the firmware would refuse without a word are named") {
  auto bench = std::make_shared<FirmwareBench>();
  const auto open = [bench] { return std::make_unique<FirmwarePort>(bench); };
  physics::CoilsDescription coils;
  const auto refused = [&](const std::string& key) {
    CHECK_THROWS_WITH(rig::SerialCoils(rig::SerialConfig(), coils, open), Catch::Contains(key));
    CHECK(bench->opened == 0);
  };
  SECTION("too small") {
    coils.resistance_20C_ohm = {1.9, 0.08, 1.9, 1.9};
    refused("rig.coils.resistance_20C_ohm of coil -x = 0.08 must be within 0.1 .. 30");
  }
  SECTION("too large") {
    coils.resistance_20C_ohm = {1.9, 1.9, 40.0, 1.9};
    refused("rig.coils.resistance_20C_ohm of coil +y = 40");
  }
  SECTION("that tells no temperature") {
    coils.temperature_coefficient_per_K = 0.0;
    refused("rig.coils.temperature_coefficient_per_K = 0 must be above 0");
  }
  SECTION("that rises too much") {
    coils.temperature_coefficient_per_K = 0.02;
    refused("at most twice its resistance");
  }
}
