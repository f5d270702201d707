#include <catch2/catch.hpp>

#include <limits>

#include "control/fakes.h"
#include "lodestone/control/safety_supervisor.h"

using namespace lodestone;

TEST_CASE("the supervisor limits current and pulse length") {
  tests::RecordingCoils device;
  control::SafetySupervisor coils(device, {10.0, 0.2, 90.0});
  coils.apply({{25.0, 0.0, 0.0, 3.0}, 1.0});
  REQUIRE(device.pulses.size() == 1);
  CHECK(device.pulses[0].current_A[0] == 10.0);
  CHECK(device.pulses[0].current_A[3] == 3.0);
  CHECK(device.pulses[0].duration_s == 0.2);
  CHECK(coils.limited() == 1);
  coils.apply({{1.0, 0.0, 0.0, 0.0}, 0.1});
  CHECK(coils.limited() == 1);
  CHECK_FALSE(coils.latched());
}

TEST_CASE("the supervisor stops the coils, keeps the reason and refuses what follows") {
  tests::RecordingCoils device;
  control::SafetySupervisor coils(device, {15.0, 0.2, 90.0});
  rig::CoilPulse pulse{{1.0, 0.0, 0.0, 0.0}, 0.1};
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
    device.state.faults = {"undervoltage"};
    expected = "undervoltage";
  }
  SECTION("hot coil") {
    device.state.temperature_C[1] = 95.0;
    expected = "coil -x is at 95 C";
  }
  SECTION("temperature unknown") {
    device.state.temperature_C[3] = std::numeric_limits<double>::quiet_NaN();
    expected = "coil -y";
  }
  CHECK_THROWS_AS(coils.apply(pulse), common::HardwareError);
  CHECK(coils.latched());
  CHECK_THAT(coils.reason(), Catch::Contains(expected));
  CHECK(device.pulses.empty());
  CHECK(device.stops == 1);
  device.state = {};
  CHECK_THROWS_AS(coils.apply({{1.0, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  CHECK(device.pulses.empty());
}
