#include "serial_session.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <future>
#include <thread>

#include "rig/firmware_port.h"
#include "rig/ring_of_coils.h"

using namespace lodestone;
using tests::FirmwareBench;
using tests::FirmwarePort;

namespace {

rig::SerialLink::OpenPort port_to(std::shared_ptr<FirmwareBench> bench) {
  return [bench] { return std::make_unique<FirmwarePort>(bench); };
}

}  // namespace

TEST_CASE("a session says hello, configures and waits until the motor controllers are ready") {
  auto bench = std::make_shared<FirmwareBench>();
  const rig::SerialSession session({}, {}, port_to(bench));
  CHECK(session.info().firmware == "1.2.1");
  CHECK(session.connections() == 1);
  CHECK(bench->device.coils.configured);
  CHECK(bench->device.coils.limits.max_current_mA == 15000);

  auto dead = std::make_shared<FirmwareBench>();
  dead->device.answering = false;
  CHECK_THROWS_WITH(rig::SerialSession({}, {}, port_to(dead)), Catch::Contains("is their supply on"));
}

TEST_CASE(
    "another number of motor controllers than the rig's coils need is one line that says what to flash") {
  CHECK_THROWS_WITH(
      rig::SerialSession({}, {}, port_to(std::make_shared<FirmwareBench>(std::uint8_t{3}))),
      Catch::Equals(
          "the coil controller's firmware is for 3 motor controllers (6 outputs), the rig's 4 coils "
          "(rig.coils, rig.serial.output) need 2 motor controllers (4 outputs): flash coils-2.hex "
          "(docs/drive-a-bench.md)"));
  CHECK_THROWS_WITH(rig::SerialSession({}, tests::ring_of(6), port_to(std::make_shared<FirmwareBench>())),
                    Catch::Contains("for 2 motor controllers") && Catch::Contains("flash coils-3.hex"));
}

TEST_CASE("the paper's four coils need no ranges, so that firmware from before has all it knows") {
  auto four = std::make_shared<FirmwareBench>();
  const rig::SerialSession session({}, {}, port_to(four));
  const std::vector<std::uint8_t>& types = four->types;
  CHECK(std::count(types.begin(), types.end(), wire::kConfigure) == 1);
  CHECK(std::count(types.begin(), types.end(), wire::kRanges) == 0);
  auto six = std::make_shared<FirmwareBench>(std::uint8_t{3});
  const rig::SerialSession of_six({}, tests::ring_of(6), port_to(six));
  CHECK(std::count(six->types.begin(), six->types.end(), wire::kRanges) == 1);
  CHECK(of_six.info().motor_controllers == 3);
  CHECK(six->device.coils.ranges.smallest_mA[5] == 0);
  CHECK(six->device.coils.ranges.largest_mA[5] == 15000);
}

TEST_CASE("after a lost link the next request connects anew") {
  auto bench = std::make_shared<FirmwareBench>();
  rig::SerialSession session({}, {}, port_to(bench));
  bench->plugged = false;
  CHECK_THROWS_AS(session.request(wire::kPing), rig::LinkLost);
  CHECK_THROWS_AS(session.request(wire::kPing), common::HardwareError);
  bench->plugged = true;
  CHECK(session.request(wire::kPing).empty());
  CHECK(session.connections() == 2);
  CHECK(bench->opened == 2);
}

// Each round a pulse that would be tried again is on its way while another thread stops; a third one watches.
TEST_CASE("a stop from another thread goes ahead of a pulse that is on its way") {
  auto bench = std::make_shared<FirmwareBench>();
  rig::SerialConfig config;
  config.max_duty = 0.9;
  rig::SerialSession session(config, {}, port_to(bench));
  const wire::PulseRequest pulse{{3000, 0, 0, 0}, 400};
  rig::SerialLink::Bytes body(wire::pulse_request_size(2));
  wire::put_pulse_request(body.data(), &pulse, 2);
  std::atomic<bool> over{false};
  std::thread watcher([&] {
    while (!over) {
      try {
        session.request(wire::kStatus);
        session.info();
      } catch (const common::HardwareError&) {  // it met a reply that was lost on purpose
      }
    }
  });
  for (int round = 0; round < 30; ++round) {
    std::future<void> driver = std::async(std::launch::async, [&] {
      for (;;) {  // until it is stopped
        try {
          session.request(wire::kPulse, body);
        } catch (const rig::LinkLost&) {
        }
      }
    });
    while (!bench->on()) std::this_thread::yield();
    std::future<void> stopper = std::async(std::launch::async, [&] {
      for (bool stopped = false; !stopped;) {
        session.stop();
        stopped = driver.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
      }
    });
    stopper.get();
    CHECK_THROWS_WITH(driver.get(), Catch::Contains("given up"));
    session.request(wire::kPing);
    CHECK_FALSE(bench->on());
  }
  over = true;
  watcher.join();
}
