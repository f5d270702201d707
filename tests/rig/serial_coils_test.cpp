#include "lodestone/rig/serial_coils.h"

#include <catch2/catch.hpp>

#include "rig/coils_conformance.h"
#include "rig/firmware_port.h"

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
