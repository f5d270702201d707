#include "coils/coils.h"

#include <catch2/catch.hpp>

#include "device.h"

using namespace lodestone;
using tests::Device;

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

TEST_CASE("a clock that goes back a little does not count for an hour") {
  Device device;
  device.start();
  const std::uint32_t uptime_ms = device.coils.uptime_ms;
  coils_tick(&device.coils, device.now_us - 5000u, false);
  CHECK(device.coils.uptime_ms - uptime_ms < 10u);
}
