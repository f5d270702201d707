#include "lodestone/emulation/live_bench.h"

#include <catch2/catch.hpp>

#include "lodestone/rig/serial_coils.h"

using namespace lodestone;

TEST_CASE("a live bench is driven through its terminal in real time") {
  emulation::LiveBench live(rig::VirtualRigConfig{}, 1);
  CHECK(live.camera().empty());
  CHECK(live.camera_serial().empty());
  live.place({0.01, 0.0, 0.3});
  CHECK(live.true_pose().x_m == 0.01);
  rig::SerialConfig serial;
  serial.port = live.port();
  rig::SerialCoils coils(serial, physics::CoilsDescription{});
  coils.apply({{5.0, 0.0, 0.0, 0.0}, 0.1});
  const common::SteadyClock clock;
  const double end_s = clock.now_s() + 5.0;
  while (live.true_pose().x_m < 0.0105 && clock.now_s() < end_s) coils.status();
  CHECK(live.true_pose().x_m > 0.0105);  // towards the coil +x
  double bench_s = 0.0;
  live.with([&](emulation::EmulatedBench& bench) { bench_s = bench.now_s(); });
  CHECK(bench_s > 0.1);
  CHECK(live.lost_s() >= 0.0);
}
