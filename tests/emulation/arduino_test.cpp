#include "lodestone/emulation/arduino.h"

#include <catch2/catch.hpp>
#include <cstddef>
#include <set>

#include "lodestone/common/error.h"

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

TEST_CASE("there is firmware for one to eight motor controllers, and it asks as many") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{3}, std::size_t{8}}) {
    std::set<int> asked;  // a packet begins with an address; nobody answers
    int packet = 0;
    double last_s = -1.0;
    emulation::Arduino* chip = nullptr;
    emulation::Arduino arduino([](std::uint8_t) {},
                               [&](std::uint8_t byte) {
                                 const double now_s = chip->now_s();
                                 packet = now_s - last_s > 2e-3 ? 0 : packet + 1;
                                 last_s = now_s;
                                 if (packet == 0) asked.insert(byte);
                               },
                               count);
    chip = &arduino;
    arduino.run_until(1.0);
    CAPTURE(count);
    REQUIRE(asked.size() == count);
    CHECK(*asked.begin() == 0x80);
    CHECK(*asked.rbegin() == 0x80 + static_cast<int>(count) - 1);
  }
  CHECK_THROWS_AS(emulation::Arduino([](std::uint8_t) {}, [](std::uint8_t) {}, 9), common::LogicFault);
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
