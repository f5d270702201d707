#include "lodestone/rig/driver_coils.h"

#include <catch2/catch.hpp>
#include <thread>

#include "coils_conformance.h"
#include "fake_driver.h"
#include "other_rigs.h"

using namespace lodestone;

namespace {

constexpr double kLong_s = 10.0;

rig::DriverConfig long_pulses() {
  rig::DriverConfig config;
  config.max_pulse_s = kLong_s;
  return config;
}

struct Driven {
  tests::FakeDriver driver;
  rig::DriverCoils coils{long_pulses(), {}, driver.open()};
};

void rest(double time_s) {
  common::SteadyClock clock;
  clock.sleep_until(clock.now_s() + time_s);
}

/// The fault that status() reports in the end.
std::string fault_within(rig::DriverCoils& coils, double time_s) {
  const common::SteadyClock clock;
  const double until_s = clock.now_s() + time_s;
  while (clock.now_s() < until_s) {
    try {
      const rig::CoilStatus status = coils.status();
      if (!status.faults.empty()) return status.faults.front();
    } catch (const common::HardwareError& error) {
      return error.what();
    }
    rest(0.01);
  }
  return "";
}

}  // namespace

TEST_CASE("coils behind a driver are coils") {
  Driven driven;
  CHECK(driven.coils.driver() == "driver fake");
  common::SteadyClock clock;
  tests::check_coils_conformance(driven.coils, clock, physics::CoilsDescription{}.max_current_A, 0.05);
}

TEST_CASE("polarities are those of the wiring, there and back, of unipolar coils, too") {
  physics::CoilsDescription description = tests::ring_rig(4).coils;
  description.polarity = {1, -1, 1, 1};
  tests::FakeDriver driver;
  std::atomic<double> wired_A = 0.0;
  driver.say([&](std::size_t coil, double current_A) {
    if (coil == 1 && current_A != 0.0) wired_A = current_A;
    return current_A;
  });
  rig::DriverCoils coils(rig::DriverConfig{}, description, driver.open());
  coils.apply({{0.0, 3.0, 0.0, 0.0}, 0.3});
  CHECK(coils.status().current_A[1] == 3.0);
  CHECK(wired_A == -3.0);
  CHECK(rig::coils_hello(description, 0.5)["coils"][1]["smallest_A"] == -description.max_current_A);
  CHECK(rig::coils_hello(description, 0.5)["coils"][1]["largest_A"] == 0.0);
}

TEST_CASE("a driver that lies about currents is found out between two calls, and its coils are off") {
  tests::FakeDriver driver;
  std::string why;
  rig::CoilPulse pulse{{5.0, 0.0, 0.0, 0.0}, kLong_s};
  SECTION("nothing in a driven coil") {
    driver.say([](std::size_t, double) { return 0.0; });
    why = "coil +x was asked for 5 A and is said to have 0 A";
  }
  SECTION("something in another") {
    driver.say([](std::size_t coil, double current_A) { return coil == 3 ? 2.0 : current_A; });
    why = "coil -y is switched off and is said to have 2 A";
  }
  SECTION("the pulse has ended, its current has not") {
    driver.say([](std::size_t coil, double) { return coil == 0 ? 5.0 : 0.0; });
    pulse.duration_s = 0.15;
    why = "coil +x is switched off and is said to have 5 A";
  }
  SECTION("in a pulse as short as those of the control loop") {
    driver.say([](std::size_t, double) { return 0.0; });
    pulse.duration_s = 0.1;
    why = "coil +x was asked for 5 A and is said to have 0 A";
  }
  SECTION("what is no number") {
    driver.say([](std::size_t, double) { return std::nan(""); });
    why = "current_A = [null,null,null,null], 4 numbers belong there";
  }
  rig::DriverCoils coils(long_pulses(), {}, driver.open());
  coils.apply(pulse);
  rest(0.6);  // nobody asks
  CHECK_FALSE(driver.on());
  CHECK_THROWS_WITH(coils.apply(pulse), Catch::Contains(why));
  CHECK_THAT(fault_within(coils, 1.0), Catch::Contains(why));
  driver.say({});
  coils.clear_faults();
  rest(0.3);
  CHECK(coils.status().faults.empty());
  coils.apply({{5.0, 0.0, 0.0, 0.0}, 0.05});
}

TEST_CASE("a driver that hangs or has gone is an error of every call") {
  Driven driven;
  driven.coils.apply({{5.0, 0.0, 0.0, 0.0}, kLong_s});
  SECTION("hangs") { driven.driver.hangs = true; }
  SECTION("dies") { driven.driver.dies = true; }
  CHECK(fault_within(driven.coils, 2.0) != "");
  CHECK_THROWS_AS(driven.coils.apply({{5.0, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  CHECK_THROWS_AS(driven.coils.status(), common::HardwareError);
  driven.coils.stop();  // never throws
  rest(0.6);            // which the driver has to see by itself
  CHECK_FALSE(driven.driver.on());
}

TEST_CASE("faults that the driver reports are handed on, and its refusal latches nothing") {
  Driven driven;
  CHECK_THROWS_WITH(driven.coils.apply({{5.0, 0.0, 0.0, 0.0}, 2.0 * kLong_s}),
                    Catch::Contains("rig.driver.max_pulse_s"));
  CHECK_THROWS_WITH(driven.coils.apply({{5.0, 5.0, 0.0, 0.0}, 0.1}),
                    Catch::Contains("driver fake refuses pulse: not together"));
  CHECK(driven.coils.status().faults.empty());
  CHECK(driven.coils.status().supply_V == 24.0);
}

TEST_CASE("a stop from another thread ends a pulse that is on its way") {
  Driven driven;
  std::atomic<bool> done{false};
  std::thread stopping([&] {
    while (!done) driven.coils.stop();
  });
  int refused = 0;
  for (int i = 0; i < 50; ++i) {
    try {
      driven.coils.apply({{5.0, 0.0, 0.0, 0.0}, kLong_s});
    } catch (const common::HardwareError&) {
      ++refused;
    }
  }
  done = true;
  stopping.join();
  driven.coils.stop();
  CHECK(refused > 0);
  CHECK_FALSE(driven.driver.on());
}

TEST_CASE("what a driver is told of the coils") {
  physics::CoilsDescription coils;
  const common::Json hello = rig::coils_hello(coils, 0.4);
  CHECK(hello["coils"].size() == 4);
  CHECK(hello["coils"][1]["name"] == "-x");
  CHECK(hello["coils"][1]["largest_A"] == coils.max_current_A);
  CHECK(hello["coils"][1]["not_with"] == common::Json{"+x"});
  CHECK(hello["max_pulse_s"] == 0.4);
  CHECK_THROWS_WITH(rig::coil_status({{"current_A", {1.0, 2.0}}}, 4),
                    Catch::Contains("current_A = [1.0,2.0], 4 numbers belong there"));
  const common::Json none = {{"current_A", {0.0, 0.0}}};
  for (const common::Json& faults : {common::Json(), common::Json("hot"), common::Json{1, 2}}) {
    common::Json bad = none;
    if (!faults.is_null()) bad["faults"] = faults;
    CHECK_THROWS_WITH(rig::coil_status(bad, 2), Catch::Contains("a list of texts belongs there"));
  }
  common::Json bad = none;
  bad["faults"] = common::Json::array();
  bad["supply_V"] = "24 V";
  CHECK_THROWS_WITH(rig::coil_status(bad, 2), Catch::Contains("supply_V = \"24 V\""));
}
