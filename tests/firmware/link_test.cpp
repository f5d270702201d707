#include "coils/coils.h"

#include <catch2/catch.hpp>

#include "device.h"

using namespace lodestone;
using tests::Device;

TEST_CASE("a motor controller that does not answer latches a fault while the other is switched off") {
  Device device;
  device.start();
  device.ask(wire::kPulse, 12, Device::pulse(3000, 400));
  device.run(20);
  device.answering = false;
  device.run(120);
  device.answering = true;
  device.run(100);
  CHECK_FALSE(device.on());
  CHECK((device.state(13).faults & wire::kFaultControllerSilent) != 0);
}
