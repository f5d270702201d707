#include "serial_limits.h"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "lodestone/common/error.h"
#include "rig/ring_of_coils.h"

using namespace lodestone;

TEST_CASE("limits go to the controller in its units") {
  rig::SerialConfig config;
  physics::CoilsDescription coils;
  coils.max_current_A = 12.5;
  config.max_pulse_s = 0.35;
  config.min_supply_V = 21.5;
  config.max_coil_C = 120.0;
  const wire::CoilLimits limits = rig::wire_limits(config, coils);
  CHECK(limits.max_current_mA == 12500);
  CHECK(limits.max_pulse_ms == 350);
  CHECK(limits.min_supply_dV == 215);
  CHECK(limits.resistance_mohm[3] == 1900);
  CHECK(limits.max_resistance_permille == 1390);  // 100 K above the cold coil, 0.39 % each
}

TEST_CASE("a pulse is rounded to the controller's units, and refused beyond the limits") {
  const rig::SerialConfig config;
  const physics::CoilsDescription coils;
  const wire::PulseRequest request = rig::wire_pulse(config, coils, {{1.2345, 0.0, -15.0, 0.0}, 0.1});
  CHECK(request.current_mA[0] == 1235);
  CHECK(request.current_mA[2] == -15000);
  CHECK(request.length_ms == 100);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(rig::wire_pulse(config, coils, {{0.0, 15.1, 0.0, 0.0}, 0.1}),
                    Catch::Contains("coil -x") && Catch::Contains("15.1"));
  CHECK_THROWS_AS(rig::wire_pulse(config, coils, {{nan, 0.0, 0.0, 0.0}, 0.1}), common::HardwareError);
  CHECK_THROWS_WITH(rig::wire_pulse(config, coils, {{}, 0.6}), Catch::Contains("duration"));
  CHECK_THROWS_AS(rig::wire_pulse(config, coils, {{}, nan}), common::HardwareError);
}

TEST_CASE("the limits of the paper's four coils are what they were, with the power of two coils") {
  const wire::CoilLimits limits = rig::wire_limits({}, {});
  CHECK(std::vector<int>(limits.opposite, limits.opposite + 4) == std::vector<int>{1, 0, 3, 2});
  CHECK(limits.max_power_W == 1155);  // 2 x 15 A^2 x 1.9 ohm x 1.351
  CHECK_FALSE(rig::need_ranges({}));
  std::vector<std::uint8_t> body(wire::coil_limits_size(2));
  wire::put_coil_limits(body.data(), &limits, 2);
  const std::vector<std::uint8_t> before = {0x98, 0x3a, 0xf4, 0x01, 0x58, 0x02, 0x10, 0x27, 0xc8, 0x00,
                                            0x20, 0x03, 0x6c, 0x07, 0x6c, 0x07, 0x6c, 0x07, 0x6c, 0x07,
                                            0x83, 0x04, 0x01, 0x00, 0x03, 0x02, 0x47, 0x05};
  CHECK(body == before);
}

TEST_CASE("six unipolar coils on six outputs have ranges of their own, as they are wired") {
  rig::SerialConfig config;
  config.output = {6, 5, 4, 3, 2, 1};
  physics::CoilsDescription ring = tests::ring_of(6);
  ring.polarity[0] = -1;
  ring.each[1].max_current_A = 4.0;
  ring.each[2].bipolar = true;
  ring.each[3].not_with = {"c4", "c5"};
  REQUIRE(rig::need_ranges(ring));
  const wire::CoilRanges ranges = rig::wire_ranges(config, ring);
  CHECK(ranges.smallest_mA[5] == -15000);  // the first coil, reversed
  CHECK(ranges.largest_mA[5] == 0);
  CHECK(ranges.largest_mA[4] == 4000);
  CHECK(ranges.smallest_mA[4] == 0);
  CHECK(ranges.smallest_mA[3] == -15000);
  CHECK(ranges.not_with[2] == (1 << 1 | 1 << 0));  // the fourth coil with the fifth and the sixth
  CHECK(ranges.not_with[1] == 1 << 2);
  const wire::CoilLimits limits = rig::wire_limits(config, ring);
  CHECK(limits.max_power_W == Approx(5 * 15.0 * 15.0 * 1.9 * 1.351).margin(1.0));  // all but the fourth
  const rig::CoilPulse pulse{{1.0, 0.0, -2.0, 0.0, 0.0, 3.0}, 0.1};
  const wire::PulseRequest request = rig::wire_pulse(config, ring, pulse);
  CHECK(std::vector<int>(request.current_mA, request.current_mA + 6) ==
        std::vector<int>{3000, 0, 0, -2000, 0, -1000});
  const rig::CoilPulse beyond{{0.0, 0.0, 0.0, 0.0, -1.0, 0.0}, 0.1};
  CHECK_THROWS_WITH(rig::wire_pulse(config, ring, beyond), Catch::Contains("coil c4"));
}

TEST_CASE("an odd coil leaves an output free, which is watched like the others and gets no current") {
  const physics::CoilsDescription ring = tests::ring_of(5);
  CHECK(rig::SerialConfig().controllers_for(5) == 3);
  const wire::CoilLimits limits = rig::wire_limits({}, ring);
  CHECK(limits.resistance_mohm[5] == 1900);
  CHECK(limits.opposite[5] == 5);
  CHECK(rig::wire_ranges({}, ring).largest_mA[5] == 0);
  rig::SerialConfig apart;
  apart.output = {1, 8};
  CHECK(apart.controllers_for(2) == 4);
}

TEST_CASE("every fault has its words, and a status of another size is refused") {
  CHECK(rig::fault_texts(0).empty());
  CHECK(rig::fault_texts(wire::kFaultSupplyLow | wire::kFaultEmergencyStop).size() == 2);
  CHECK(rig::fault_texts(0xffff).size() == wire::kFaultCount);
  CHECK_THROWS_AS(rig::coil_state(std::vector<std::uint8_t>(36), 2), common::HardwareError);
  CHECK_THROWS_AS(rig::coil_state(std::vector<std::uint8_t>(37), 3), common::HardwareError);
}
