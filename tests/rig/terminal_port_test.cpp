#include "terminal_port.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
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

TEST_CASE("a port belongs to one program, root or not, until it ends, however it ends") {
  const int device = posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(device >= 0);
  REQUIRE(grantpt(device) == 0);
  REQUIRE(unlockpt(device) == 0);
  const std::string name = ptsname(device);
  REQUIRE(chmod(name.c_str(), 0666) == 0);
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  const pid_t holder = fork();
  if (holder == 0) {
    const auto port = rig::open_terminal(name);
    const ssize_t told = write(ready[1], "x", 1);
    if (told == 1) pause();
    _exit(0);
  }
  char byte = 0;
  REQUIRE(read(ready[0], &byte, 1) == 1);
  CHECK_THROWS_WITH(rig::open_terminal(name), Catch::Contains("another program has it open"));
  kill(holder, SIGKILL);
  waitpid(holder, nullptr, 0);
  const pid_t next = fork();  // who is not root, where we are
  if (next == 0) {
    if (getuid() == 0 && setuid(65534) != 0) _exit(2);
    try {
      rig::open_terminal(name);
      _exit(0);
    } catch (const common::HardwareError&) {
      _exit(1);
    }
  }
  int status = 0;
  waitpid(next, &status, 0);
  CHECK(WEXITSTATUS(status) == 0);
  close(ready[0]);
  close(ready[1]);
  close(device);
}
