#include "descriptor_port.h"

#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <vector>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("a socket is a port: bytes pass, time-outs hold, and an end that has gone is named") {
  int ends[2];
  REQUIRE(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0);
  rig::DescriptorPort port(ends[0], "driver x", "has it ended?");
  const std::uint8_t sent[] = {1, 0, 255};
  std::uint8_t got[8] = {};
  port.write(sent, sizeof sent, 0.1);
  REQUIRE(read(ends[1], got, sizeof got) == 3);
  CHECK(got[2] == 255);
  CHECK(port.read(got, sizeof got, 0.01) == 0);
  REQUIRE(write(ends[1], sent, 2) == 2);
  CHECK(port.read(got, sizeof got, 0.1) == 2);
  REQUIRE(write(ends[1], sent, 2) == 2);
  port.discard_input();
  CHECK(port.read(got, sizeof got, 0.01) == 0);
  const std::vector<std::uint8_t> much(1U << 22U);
  CHECK_THROWS_WITH(port.write(much.data(), much.size(), 0.05), "driver x takes no bytes");
  close(ends[1]);
  CHECK_THROWS_WITH(port.read(got, sizeof got, 0.1), "driver x has gone: has it ended?");
  CHECK_THROWS_WITH(port.write(sent, sizeof sent, 0.1), "driver x has gone: has it ended?");
}
