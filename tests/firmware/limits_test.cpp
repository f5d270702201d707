#include "coils/coils.h"

#include <catch2/catch.hpp>

#include "device.h"

using namespace lodestone;
using tests::Device;
using tests::refusal;

TEST_CASE("limits are refused, faults latch and stay until cleared") {
  Device device;
  device.start();
  CHECK(refusal(device.ask(wire::kPulse, 12, Device::pulse(15001, 50))) == wire::kRefusedLimit);
  CHECK(refusal(device.ask(wire::kPulse, 13, Device::pulse(1000, 2001))) == wire::kRefusedLimit);
  CHECK(refusal(device.ask(wire::kPulse, 14, {1, 2, 3})) == wire::kRefusedBody);
  CHECK(refusal(device.ask(0x44, 15)) == wire::kRefusedBody);
  std::uint16_t sequence = 16;
  int fault = 0;
  SECTION("the PC falls silent") {
    device.ask(wire::kPulse, sequence++, Device::pulse(3000, 2000));
    device.run(490);
    CHECK(device.on());
    device.run(30);
    CHECK_FALSE(coils_contactor(&device.coils));  // at once, whether or not the motor controllers obey
    fault = wire::kFaultHostSilent;
  }
  SECTION("the emergency stop opens") {
    device.ask(wire::kPulse, sequence++, Device::pulse(3000, 400));
    device.open_switch = true;
    device.run(5);
    device.open_switch = false;
    CHECK_FALSE(coils_contactor(&device.coils));
    fault = wire::kFaultEmergencyStop;
  }
  SECTION("the supply sags") {
    device.supply_dV = 120;
    device.run(300);
    device.supply_dV = 340;
    device.run(300);
    fault = wire::kFaultSupplyLow;
  }
  SECTION("a motor controller gets hot") {
    device.board_dC = 900;
    device.run(400);
    device.board_dC = 300;
    device.run(400);
    fault = wire::kFaultBoardHot;
  }
  CHECK_FALSE(device.on());
  CHECK((device.state(sequence++).faults & fault) != 0);
  CHECK(refusal(device.ask(wire::kPulse, sequence++, Device::pulse(1000, 50))) == wire::kRefusedFault);
  device.ask(wire::kClear, sequence++);
  device.run(400);
  CHECK(device.state(sequence++).faults == 0);
  CHECK(device.ask(wire::kPulse, sequence++, Device::pulse(1000, 50)).type == (wire::kPulse | wire::kReply));
}

TEST_CASE("a pulse of 100 ms tells a coil that is hot or hardly connected, at the strongest current, too") {
  const int current_mA = GENERATE(2000, 8000, 15000);
  Device device;
  device.start();
  SECTION("as it should be") {
    device.ask(wire::kPulse, 12, Device::pulse(current_mA, 100));
    device.run(150);
    CHECK(device.state(13).faults == 0);
  }
  SECTION("hot") {
    device.coil_10mohm = 300;
    device.ask(wire::kPulse, 12, Device::pulse(current_mA, 100));
    device.run(150);
    CHECK((device.state(13).faults & wire::kFaultCoilHot) != 0);
  }
  SECTION("a bad contact") {
    device.coil_10mohm = 2500;
    device.ask(wire::kPulse, 12, Device::pulse(current_mA, 100));
    device.run(150);
    CHECK((device.state(13).faults & wire::kFaultNoCurrent) != 0);
  }
}

TEST_CASE("a current for a moment is none that stays, however long the coils have rested") {
  Device device;
  device.start();
  constexpr double kMinute_ms = 60'000;
  device.run(40 * kMinute_ms, 4000);  // the clock's half round is 35.8 minutes
  device.stray_10mA = 40;
  device.run(120);
  device.stray_10mA = 0;
  device.run(400);
  CHECK(device.state(12).faults == 0);
}
