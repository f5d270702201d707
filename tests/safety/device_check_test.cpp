#include "lodestone/safety/device_check.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("a fault that the device reports is not trusted") {
  safety::DeviceCheck check;
  rig::CoilPulse pulse;
  safety::PulseContext context;
  check.check(pulse, context);
  context.status.faults = {"undervoltage", "too hot"};
  CHECK_THROWS_WITH(check.check(pulse, context), "the coils report: undervoltage");
}
