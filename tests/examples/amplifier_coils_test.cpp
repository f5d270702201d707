#include "amplifier_coils.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "control/fakes.h"
#include "lodestone/safety/supervisor.h"
#include "paper_rig.h"
#include "rig/coils_conformance.h"
#include "rig/fake_coils.h"

using namespace lodestone;

TEST_CASE("an example's coils keep the contract of Coils") {
  tests::FakeRigClock clock;
  tests::FakeCoils device(clock, 15.0);
  vendor::Amplifier amplifier(device);
  std::ostringstream log;
  AmplifierCoils coils(amplifier, log);
  tests::check_coils_conformance(coils, clock, 15.0, 0.1);
  CHECK(device.pulses.size() == 8);
}

TEST_CASE("an example's coils are wired as they are named, and log what they gave") {
  tests::FakeRigClock clock;
  tests::FakeCoils device(clock, 15.0);
  vendor::Amplifier amplifier(device);
  std::ostringstream log;
  AmplifierCoils coils(amplifier, log);
  coils.apply({{1.2344, -2.0, 3.5, -4.25}, 0.1});
  REQUIRE(device.pulses.size() == 1);
  const std::array<double, 4> whole_mA{1.234, -2.0, 3.5, -4.25};
  for (int coil = 0; coil < 4; ++coil) {
    CHECK(device.pulses[0].current_A[coil] == Approx(whole_mA[coil]).margin(1e-12));
    CHECK(coils.status().current_A[coil] == Approx(whole_mA[coil]).margin(1e-12));
    CHECK(coils.status().temperature_C[coil] == 20.0);
  }
  CHECK(device.pulses[0].duration_s == Approx(0.1));
  CHECK_THROWS_AS(coils.apply({{16.0, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  CHECK_THROWS_AS(coils.apply({{1e12, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  CHECK(log.str() ==
        "current_px_A,current_mx_A,current_py_A,current_my_A,duration_s\n1.2344,-2,3.5,-4.25,0.1\n");
}

TEST_CASE("an alarm of the example's amplifier stops the run") {
  tests::RecordingCoils device;
  tests::ManualClock clock;
  device.state.temperature_C.assign(4, 22.0);
  vendor::Amplifier amplifier(device);
  std::ostringstream log;
  AmplifierCoils coils(amplifier, log);
  safety::Supervisor supervisor(coils, {}, tests::paper_rig(), clock);
  const auto step = [&] {
    supervisor.begin_step(clock.now_s());
    control::PoseEstimate estimate;
    estimate.valid = true;
    estimate.stamp_s = clock.now_s();
    supervisor.observe(estimate);
    supervisor.apply({{1.0, 0.0, 0.0, 0.0}, 0.1});
    clock.sleep_until(clock.now_s() + 0.3);
  };
  step();
  CHECK(device.on);
  device.state.faults = {"channel 2 is too hot"};
  CHECK_THROWS_WITH(step(), Catch::Contains("amplifier alarm: channel 2 is too hot"));
  CHECK_FALSE(device.on);
  CHECK(supervisor.latched());
}
