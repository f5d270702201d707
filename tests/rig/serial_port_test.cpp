#include "lodestone/rig/serial_port.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("a port that is missing, none, or no port is named, with what there is") {
  CHECK_THROWS_WITH(
      rig::open_serial_port("/dev/ttyNOTHING", 115200),
      Catch::Contains("/dev/ttyNOTHING cannot be opened: there is no such port") && Catch::Contains("found"));
  CHECK_THROWS_AS(rig::open_serial_port("", 115200), common::ConfigError);
  CHECK_THROWS_AS(rig::open_serial_port("/dev/null", 115200), common::HardwareError);
  for (const rig::SerialPortInfo& port : rig::list_serial_ports()) CHECK_FALSE(port.name.empty());
}
