#include "pseudo_terminal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>

using namespace lodestone;

TEST_CASE("what a program writes to the terminal's name arrives as it is, and the other way") {
  emulation::PseudoTerminal line;
  const int program = open(line.name().c_str(), O_RDWR | O_NOCTTY);
  REQUIRE(program >= 0);
  const std::uint8_t sent[] = {0x00, 0x0a, 0x0d, 0x03, 0xff};
  std::uint8_t got[16] = {};
  REQUIRE(write(program, sent, sizeof sent) == static_cast<ssize_t>(sizeof sent));
  REQUIRE(line.read(got, sizeof got, 1e-3) == sizeof sent);
  CHECK(std::equal(std::begin(sent), std::end(sent), got));
  line.write(sent, 3);
  CHECK(read(program, got, sizeof got) == 3);
  close(program);
  CHECK(line.read(got, sizeof got, 1e-3) == 0);  // the line stays up while nobody has it open
}
