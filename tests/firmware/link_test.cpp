#include "coils/coils.h"

#include <catch2/catch.hpp>
#include <vector>

#include "device.h"

using namespace lodestone;
using tests::Device;

TEST_CASE("a motor controller that does not answer latches a fault while the other is switched off") {
  Device device;
  device.start();
  device.ask(wire::kPulse, 12, Device::pulse(3000, 400));
  device.run(20);
  device.answering = false;
  device.run(120);
  device.answering = true;
  device.run(100);
  CHECK_FALSE(device.on());
  CHECK((device.state(13).faults & wire::kFaultControllerSilent) != 0);
}

TEST_CASE("coils of one, three, four and eight motor controllers begin and end together, each with its own") {
  for (const int count : {1, 3, 4, 8}) {
    CAPTURE(count);
    const auto controllers = static_cast<std::uint8_t>(count);
    Device device(controllers);
    device.start();
    REQUIRE((device.state(12).state & wire::kStateReady) != 0);
    std::vector<int> mA(2 * static_cast<std::size_t>(count), 0);  // one output of each controller, by turns
    for (std::size_t c = 0; c < controllers; ++c) mA[2 * c + c % 2] = 1000 + 100 * static_cast<int>(c);
    const int drives = device.drives;
    CHECK(device.ask(wire::kPulse, 13, Device::pulse(mA, 100, controllers)).type ==
          (wire::kPulse | wire::kReply));
    device.run(1.0);  // one look at the bus, and one at its answer
    CHECK(device.drives == drives + count);
    for (std::size_t i = 0; i < mA.size(); ++i) CHECK((device.duty[i] != 0) == (mA[i] != 0));
    device.run(90.0);
    const wire::CoilState during = device.state(14);
    for (std::size_t i = 0; i < mA.size(); ++i)
      CHECK(static_cast<double>(during.current_mA[i]) == Approx(mA[i]).margin(0.05 * 1000));
    device.run(200.0);
    CHECK_FALSE(device.on());
    CHECK(device.state(15).faults == 0);
  }
}

TEST_CASE("controllers that have no change are left alone, and those that have one change together") {
  Device device(4);
  device.start();
  CHECK(device.ask(wire::kPulse, 12, Device::pulse({2000, 0, 0, 0, 0, 1500, 0, 0}, 100, 4)).type ==
        (wire::kPulse | wire::kReply));
  coils_tick(&device.coils, device.now_us += 500, false);
  if (device.packets.empty() || device.packets.front()[1] != kDriveDuty) {  // a reading was on its way
    device.answer();
    coils_tick(&device.coils, device.now_us += 500, false);
  }
  REQUIRE(device.packets.size() == 2);
  CHECK(device.packets[0][0] == kRoboClawAddress);
  CHECK(device.packets[1][0] == kRoboClawAddress + 2);
  device.answer();
  device.run(20.0);
  CHECK(device.duty[0] > 0);
  CHECK(device.duty[5] > 0);
}
