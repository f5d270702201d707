#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include "control/fakes.h"
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
    device.state.temperature_C.fill(22.0);
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

TEST_CASE("missed deadlines in a row stop the run, single ones do not") {
  Bench bench;
  for (int i = 0; i < 5; ++i) {
    bench.coils->begin_step(bench.clock.now_s() - 0.2);
    bench.coils->begin_step(bench.clock.now_s() - 0.2);
    bench.coils->begin_step(bench.clock.now_s() - 0.05);
  }
  bench.coils->begin_step(bench.clock.now_s() - 0.2);
  bench.coils->begin_step(bench.clock.now_s() - 0.2);
  CHECK_THROWS_AS(bench.coils->begin_step(bench.clock.now_s() - 0.2), common::HardwareError);
  CHECK_THAT(bench.coils->reason(), Catch::Contains("3 steps in a row began late"));
}

TEST_CASE("a coil that is on for too large a fraction of the time stops the run") {
  Bench bench;
  bench.config.max_pulse_s = 0.5;
  bench.config.max_duty = 0.5;
  bench.config.duty_window_s = 2.0;
  bench.start();
  int pulses = 0;
  CHECK_THROWS_AS(
      [&] {
        for (; pulses < 100; ++pulses) bench.step({{1.0, 0.0, 0.0, 0.0}, 0.3});
      }(),
      common::HardwareError);
  // Always on: 0.15 s of excess per step, against 1 s.
  CHECK(pulses == 6);
  CHECK_THAT(bench.coils->reason(), Catch::Contains("50 % of the time"));

  bench.start();
  for (int i = 0; i < 100; ++i) bench.step({{1.0, 0.0, 0.0, 0.0}, 0.14});
  CHECK_FALSE(bench.coils->latched());
}

TEST_CASE("temperatures are checked against what the pulses explain") {
  Bench bench;
  const rig::CoilPulse strong{{5.0, 0.0, 0.0, 0.0}, 0.1};
  bench.device.state.temperature_C[0] = 70.0;  // warm from an earlier run: nobody here can know better
  bench.step(strong);
  bench.step(strong);
  CHECK_FALSE(bench.coils->latched());
  bench.device.state.temperature_C[0] = 20.0;
  bench.coils->observe(bench.pose());
  CHECK_THROWS_AS(bench.coils->apply(strong), common::HardwareError);
  CHECK_THAT(bench.coils->reason(), Catch::Contains("measures 20 C where its pulses explain 6"));
}

TEST_CASE("the thermal model heats as R i2 and cools towards the room") {
  physics::RigDescription rig;
  rig.coils.temperature_coefficient_per_K = 0.0;
  safety::ThermalModel model(rig);
  model.advance({10.0, 0.0, 0.0, 0.0}, 1e6, 1e6);
  CHECK(model.temperature_C(0) == Approx(22.0 + 190.0 / 15.0));
  CHECK(model.temperature_C(1) == Approx(22.0));
  const double tau_s = 651.0 / 15.0;
  model.advance({}, 0.0, tau_s);
  CHECK(model.temperature_C(0) == Approx(22.0 + 190.0 / 15.0 * std::exp(-1.0)));
}

TEST_CASE("a stop file stops the run") {
  Bench bench;
  const auto folder =
      std::filesystem::temp_directory_path() / ("lodestone-stop-test-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  bench.config.stop_file = (folder / "STOP").string();
  std::filesystem::remove(bench.config.stop_file);
  bench.start();
  bench.step(kPulse);
  std::ofstream(bench.config.stop_file) << "";
  CHECK_THROWS_AS(bench.coils->begin_step(bench.clock.now_s()), common::HardwareError);
  CHECK_THAT(bench.coils->reason(), Catch::Contains("STOP exists"));
  CHECK_FALSE(bench.device.on);
  std::filesystem::remove_all(folder);
}
