#include "serial_limits.h"

#include <catch2/catch.hpp>
#include <limits>

#include "lodestone/common/error.h"

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

TEST_CASE("every fault has its words, and a status of another size is refused") {
  CHECK(rig::fault_texts(0).empty());
  CHECK(rig::fault_texts(wire::kFaultSupplyLow | wire::kFaultEmergencyStop).size() == 2);
  CHECK(rig::fault_texts(0xffff).size() == wire::kFaultCount);
  CHECK_THROWS_AS(rig::coil_state(std::vector<std::uint8_t>(36)), common::HardwareError);
}
