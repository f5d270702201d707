#include "lodestone/emulation/arduino.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("the firmware asks its motor controllers, and its watchdog resets it when it hangs") {
  int asked = 0;
  emulation::Arduino arduino([](std::uint8_t) {}, [&](std::uint8_t) { ++asked; });
  arduino.run_until(0.3);
  CHECK(arduino.now_s() >= 0.3);
  CHECK(arduino.now_s() < 0.31);
  CHECK(asked > 0);
  CHECK(arduino.resets() == 0);
  arduino.hang();
  arduino.run_until(1.5);
  CHECK(arduino.resets() == 1);
}

TEST_CASE("wherever the firmware hangs, one reset brings it back") {
  for (int moment = 0; moment < 30; ++moment) {
    emulation::Arduino arduino([](std::uint8_t) {}, [](std::uint8_t) {});
    arduino.run_until(0.3 + 0.37e-3 * moment);
    arduino.hang();
    arduino.run_until(1.2);
    CAPTURE(moment);
    CHECK(arduino.resets() == 1);
  }
}
