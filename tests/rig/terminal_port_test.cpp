#include "terminal_port.h"

#include <fcntl.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("bytes pass through a pseudo-terminal as they are, and a line that has gone is named") {
  const int device = posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(device >= 0);
  REQUIRE(grantpt(device) == 0);
  REQUIRE(unlockpt(device) == 0);
  const auto port = rig::open_serial_port(ptsname(device), 115200);
  const std::uint8_t sent[] = {0x00, 0x0a, 0x0d, 0x03, 0xff};  // what a terminal would take for commands
  port->write(sent, sizeof sent, 1.0);
  std::uint8_t got[16] = {};
  REQUIRE(read(device, got, sizeof got) == static_cast<ssize_t>(sizeof sent));
  CHECK(std::equal(std::begin(sent), std::end(sent), got));
  REQUIRE(write(device, sent, sizeof sent) == static_cast<ssize_t>(sizeof sent));
  CHECK(port->read(got, sizeof got, 1.0) == sizeof sent);
  CHECK(port->read(got, sizeof got, 0.01) == 0);
  close(device);
  CHECK_THROWS_AS(port->read(got, sizeof got, 0.1), common::HardwareError);
  CHECK_THROWS_AS(rig::open_terminal("/dev/pts/987654"), common::HardwareError);
}
