#include "lodestone/emulation/lockstep_port.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("waiting for bytes is what advances the bench, and a pulled plug ends it") {
  rig::VirtualRig rig(rig::VirtualRigConfig{}, 1);
  emulation::EmulatedBench bench(rig);
  emulation::LockstepPort port(bench);
  std::uint8_t bytes[8] = {};
  const double start_s = bench.now_s();
  CHECK(port.read(bytes, sizeof bytes, 0.05) == 0);
  CHECK(bench.now_s() == Approx(start_s + 0.05));
  bench.inject_to_host({1, 2, 3});
  CHECK(port.read(bytes, sizeof bytes, 0.05) >= 1);
  CHECK(bytes[0] == 1);
  bench.inject_to_host({4});
  bench.advance_to(bench.now_s() + 0.01);
  port.discard_input();
  CHECK(port.read(bytes, sizeof bytes, 0.01) == 0);
  bench.set_plugged(false);
  CHECK_THROWS_AS(port.read(bytes, sizeof bytes, 0.05), common::HardwareError);
  CHECK_THROWS_AS(emulation::LockstepPort(bench), common::HardwareError);
}
