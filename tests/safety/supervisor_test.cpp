#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <thread>

#include "control/fakes.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/safety/supervisor.h"
#include "paper_rig.h"

using namespace lodestone;
using safety::Supervisor;

namespace {

struct Bench {
  tests::RecordingCoils device;
  tests::ManualClock clock;
  safety::SafetyConfig config;
  std::unique_ptr<Supervisor> coils;

  Bench() {
    device.state.temperature_C.assign(4, 22.0);
    start();
  }
  void start() { coils = std::make_unique<Supervisor>(device, config, tests::paper_rig(), clock); }
  control::PoseEstimate pose(double x_m = 0.0) const {
    control::PoseEstimate estimate;
    estimate.valid = true;
    estimate.pose = {x_m, 0.0, 0.0};
    estimate.stamp_s = clock.now_s();
    return estimate;
  }
  void wait(double time_s) { clock.sleep_until(clock.now_s() + time_s); }
  /// A step as the control loop takes it.
  void step(const rig::CoilPulse& pulse) {
    coils->begin_step(clock.now_s());
    coils->observe(pose());
    coils->apply(pulse);
    wait(0.3);
  }
};

const rig::CoilPulse kPulse{{1.0, 0.0, 0.0, 0.0}, 0.1};

}  // namespace

TEST_CASE("the supervisor limits current, power and pulse length") {
  Bench bench;
  bench.config.max_current_A = 10.0;
  bench.config.max_pulse_s = 0.2;
  bench.start();
  bench.step({{25.0, 0.0, 0.0, 3.0}, 1.0});
  REQUIRE(bench.device.pulses.size() == 1);
  CHECK(bench.device.pulses[0].current_A[0] == 10.0);
  CHECK(bench.device.pulses[0].current_A[3] == 3.0);
  CHECK(bench.device.pulses[0].duration_s == 0.2);
  CHECK(bench.coils->limited() == 1);
  bench.step(kPulse);
  CHECK(bench.coils->limited() == 1);
  CHECK_FALSE(bench.coils->latched());

  bench.config.max_power_W = 38.0;  // 2 x 1.9 ohm x (about 3.16 A)^2
  bench.start();
  bench.step({{6.0, 0.0, -6.0, 0.0}, 0.1});
  const rig::CoilPulse& cut = bench.device.pulses.back();
  CHECK(cut.current_A[0] == Approx(3.15).epsilon(0.01));
  CHECK(cut.current_A[2] == -cut.current_A[0]);
}

TEST_CASE("a needle in a keep-out zone stops the coils for good, also where the zone has come to it") {
  Bench bench;
  SECTION("the needle comes") {
    bench.config.keep_out = {{"wall", {0.03, -0.01, 0.03, 0.01}, 0.001}};
    bench.start();
    bench.step(kPulse);
    CHECK_THROWS_AS(bench.coils->observe(bench.pose(0.02)), common::HardwareError);
  }
  SECTION("the zone comes") {
    bench.step(kPulse);
    bench.coils->move_keep_out({{"wall", {0.0, -0.01, 0.0, 0.01}, 0.001}});
    CHECK_THROWS_AS(bench.coils->observe(bench.pose()), common::HardwareError);
  }
  CHECK(bench.coils->latched());
  CHECK_THAT(bench.coils->reason(), Catch::Contains("keep-out zone wall"));
  CHECK_THROWS_AS(bench.coils->apply(kPulse), common::HardwareError);
  CHECK(bench.device.pulses.size() == 1);
}

TEST_CASE("the supervisor stops the coils, keeps the reason and refuses what follows") {
  Bench bench;
  rig::CoilPulse pulse = kPulse;
  std::string expected;
  SECTION("NaN current") {
    pulse.current_A[2] = std::numeric_limits<double>::quiet_NaN();
    expected = "+y";
  }
  SECTION("infinite duration") {
    pulse.duration_s = std::numeric_limits<double>::infinity();
    expected = "pulse length";
  }
  SECTION("negative duration") {
    pulse.duration_s = -0.1;
    expected = "pulse length";
  }
  SECTION("opposite coils together") {
    pulse.current_A[1] = 2.0;
    expected = "opposite coils +x and -x";
  }
  SECTION("reported fault") {
    bench.device.state.faults = {"undervoltage"};
    expected = "undervoltage";
  }
  SECTION("hot coil") {
    bench.device.state.temperature_C[1] = 95.0;
    expected = "coil -x is at 95 C";
  }
  SECTION("temperature unknown") {
    bench.device.state.temperature_C[3] = std::numeric_limits<double>::quiet_NaN();
    expected = "coil -y";
  }
  SECTION("a device that does not take it") {
    bench.device.fail_at = 0;
    expected = "no answer";
  }
  SECTION("a pulse that would overheat the coil") {
    bench.config.max_temperature_C = 22.03;
    bench.start();
    pulse.current_A[0] = 12.0;
    expected = "would heat coil +x";
  }
  bench.coils->observe(bench.pose());
  CHECK_THROWS_AS(bench.coils->apply(pulse), common::HardwareError);
  CHECK(bench.coils->latched());
  CHECK_THAT(bench.coils->reason(), Catch::Contains(expected));
  CHECK(bench.device.pulses.empty());
  CHECK(bench.device.stops == 1);
  bench.device.state = {};
  bench.device.fail_at = -1;
  CHECK_THROWS_AS(bench.coils->apply(kPulse), common::HardwareError);
  CHECK_THROWS_AS(bench.coils->observe(bench.pose()), common::HardwareError);
  CHECK_THROWS_AS(bench.coils->begin_step(bench.clock.now_s()), common::HardwareError);
  CHECK(bench.device.pulses.empty());
}

TEST_CASE("an operator who has seen the reason takes pulses again, once its cause is gone") {
  Bench bench;
  bench.step(kPulse);
  SECTION("a fault of the device") {
    bench.device.state.faults = {"undervoltage"};
    CHECK_THROWS_AS(bench.step(kPulse), common::HardwareError);
    CHECK_THROWS_WITH(bench.coils->rearm(), Catch::Contains("undervoltage"));
    CHECK(bench.coils->latched());
    bench.device.state.faults.clear();
  }
  SECTION("a coil that is too hot") {
    bench.device.state.temperature_C[1] = 95.0;
    CHECK_THROWS_AS(bench.step(kPulse), common::HardwareError);
    CHECK_THROWS_WITH(bench.coils->check_cause_is_gone(), Catch::Contains("coil -x is at 95 C"));
    CHECK_THROWS_AS(bench.coils->rearm(), common::HardwareError);
    bench.device.state.temperature_C[1] = 30.0;
    bench.wait(60.0);
  }
  SECTION("somebody has said stop") {
    bench.coils->request_stop("the operator");
    CHECK_THROWS_AS(bench.step(kPulse), common::HardwareError);
  }
  SECTION("somebody has said stop while nothing was driven") { bench.coils->request_stop("the operator"); }
  const std::size_t before = bench.device.pulses.size();
  bench.coils->rearm();
  CHECK_FALSE(bench.coils->latched());
  CHECK(bench.coils->reason().empty());
  CHECK_THROWS_AS(bench.coils->apply(kPulse), common::HardwareError);  // nobody has seen the needle since
  bench.coils->rearm();
  bench.step(kPulse);
  CHECK(bench.device.pulses.size() == before + 1);
}

TEST_CASE("a stop does not let a coil have more than its share of the time") {
  Bench bench;
  const auto use_up = [&] {
    for (int step = 0; step < 100; ++step) {
      bench.coils->begin_step(bench.clock.now_s());
      bench.coils->observe(bench.pose());
      bench.coils->apply({{0.5, 0.0, 0.0, 0.0}, 0.25});
      bench.wait(0.25);
    }
  };
  CHECK_THROWS_WITH(use_up(), Catch::Contains("60 %"));
  bench.coils->rearm();
  bench.coils->begin_step(bench.clock.now_s());
  bench.coils->observe(bench.pose());
  CHECK_THROWS_WITH(bench.coils->apply({{0.5, 0.0, 0.0, 0.0}, 0.25}), Catch::Contains("60 %"));
  bench.coils->rearm();
  bench.wait(10.0);
  bench.step(kPulse);
  CHECK_FALSE(bench.coils->latched());
}

TEST_CASE("no pulse without a pose that is new, young and inside the fence") {
  Bench bench;
  bench.step(kPulse);
  std::string expected;
  SECTION("no pose since the last pulse") { expected = "nobody has seen the needle"; }
  SECTION("a lost needle") {
    control::PoseEstimate lost = bench.pose();
    lost.valid = false;
    bench.coils->observe(lost);
    expected = "nobody has seen the needle";
  }
  SECTION("an old pose") {
    const control::PoseEstimate old = bench.pose();
    bench.wait(0.6);
    CHECK_THROWS_AS(bench.coils->observe(old), common::HardwareError);
    expected = "the pose is 0.6 s old";
  }
  SECTION("the same pose again") {
    const control::PoseEstimate first = bench.pose();
    bench.coils->observe(first);
    bench.wait(0.3);
    CHECK_THROWS_AS(bench.coils->observe(first), common::HardwareError);
    expected = "the same pose";
  }
  SECTION("a needle outside the fence") {
    CHECK_THROWS_AS(bench.coils->observe(bench.pose(0.061)), common::HardwareError);
    expected = "61 mm from the dish centre";
  }
  if (!bench.coils->latched()) CHECK_THROWS_AS(bench.coils->apply(kPulse), common::HardwareError);
  CHECK_THAT(bench.coils->reason(), Catch::Contains(expected));
  CHECK(bench.device.pulses.size() == 1);
  CHECK_FALSE(bench.device.on);
}

// The driver pulses on, another thread asks for a stop, and a third one watches.
TEST_CASE("a stop that any thread asks for is kept, and no pulse survives it") {
  const auto table = rig::VirtualRig(rig::VirtualRigConfig{}, 1).fields();
  for (int round = 0; round < 20; ++round) {
    rig::VirtualRig rig(rig::VirtualRigConfig{}, 1, table);
    safety::SafetyConfig config;
    Supervisor coils(rig.coils(), config, rig.config(), rig.clock(), Supervisor::Poses::kNone);
    std::atomic<bool> over{false};
    std::thread watcher([&] {
      while (!over) {
        coils.status();
        coils.reason();
        coils.limited();
      }
    });
    std::thread driver([&] {
      try {
        for (;;) {
          coils.begin_step(rig.clock().now_s());
          coils.apply({{20.0, 0.0, 0.0, 0.0}, 0.1});
          rig.clock().sleep_until(rig.clock().now_s() + 0.3);
        }
      } catch (const common::HardwareError&) {
      }
    });
    while (coils.limited() < 2) std::this_thread::yield();
    coils.request_stop("somebody at the other end of the room");
    driver.join();
    over = true;
    watcher.join();
    CHECK(coils.latched());
    CHECK(coils.reason() == "somebody at the other end of the room");
    rig.clock().sleep_until(rig.clock().now_s() + 0.2);
    CHECK(std::abs(coils.status().current_A[0]) < 0.2);
    CHECK_THROWS_AS(coils.apply(kPulse), common::HardwareError);
  }
}

TEST_CASE(
    "a device that does not answer and a sensor that fails stop for good, and stay stopped when they are "
    "back") {
  Bench bench;
  bench.step(kPulse);
  SECTION("coils") {
    bench.device.silent = true;
    CHECK_THROWS_WITH(bench.step(kPulse), Catch::Contains("no answer"));
    bench.device.silent = false;
  }
  SECTION("sensor") {
    control::PoseEstimate none;
    none.fault = true;
    none.reason = "camera unplugged";
    CHECK_THROWS_WITH(bench.coils->observe(none), Catch::Contains("camera unplugged"));
  }
  CHECK(bench.coils->latched());
  CHECK_FALSE(bench.device.on);
  CHECK_THROWS_WITH(bench.step(kPulse), Catch::Contains("stopped earlier"));
  CHECK(bench.device.pulses.size() == 1);
}

TEST_CASE("every bound can trip within its range") {
  Bench bench;
  bench.config.max_duty = 0.9;
  bench.config.duty_window_s = 60.0;
  bench.start();
  CHECK_THROWS_WITH(
      [&] {
        for (int step = 0; step < 4000; ++step) {
          bench.coils->begin_step(bench.clock.now_s());
          bench.coils->observe(bench.pose());
          bench.coils->apply({{0.5, 0.0, 0.0, 0.0}, 0.2});
          bench.wait(0.2);
        }
      }(),
      Catch::Contains("90 %"));
  common::Json beyond = {{"max_duty", 1.0}};
  CHECK_THROWS_AS(common::config_from_json<safety::SafetyConfig>(beyond, "test"), common::ConfigError);
  beyond = {{"geofence", 1.6}};
  CHECK_THROWS_AS(common::config_from_json<safety::SafetyConfig>(beyond, "test"), common::ConfigError);
}

TEST_CASE(
    "a place that was seen is good for one pulse, though not which end is the head; for no more probes") {
  tests::RecordingCoils device;
  tests::ManualClock clock;
  safety::Supervisor coils(device, safety::SafetyConfig{}, tests::paper_rig(), clock);
  const auto see_either_way = [&] {
    control::PoseEstimate estimate;
    estimate.either_way = true;
    clock.sleep_until(clock.now_s() + 0.3);
    estimate.stamp_s = clock.now_s();
    coils.observe(estimate);
  };
  see_either_way();
  coils.apply({{1.0, 0.0, 0.0, 0.0}, 0.1});
  SECTION("one pulse") { CHECK_THROWS_AS(coils.apply({{1.0, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError); }
  SECTION("six probes since the last pose") {
    for (int probe = 0; probe < 6; ++probe) {
      see_either_way();
      coils.probe({{1.0, 0.0, 0.0, 0.0}, 0.1});
    }
    see_either_way();
    CHECK_THROWS_AS(coils.probe({{1.0, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  }
  SECTION("not outside the fence") {
    control::PoseEstimate outside;
    outside.either_way = true;
    outside.pose.x_m = 0.5;
    clock.sleep_until(clock.now_s() + 0.3);
    outside.stamp_s = clock.now_s();
    CHECK_THROWS_AS(coils.observe(outside), common::HardwareError);
  }
}
