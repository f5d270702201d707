#include "serial_session.h"

#include <catch2/catch.hpp>
#include <future>
#include <thread>

#include "rig/firmware_port.h"

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
  CHECK(session.info().firmware == "1.1.0");
  CHECK(session.connections() == 1);
  CHECK(bench->device.coils.configured);
  CHECK(bench->device.coils.limits.max_current_mA == 15000);

  auto dead = std::make_shared<FirmwareBench>();
  dead->device.answering = false;
  CHECK_THROWS_WITH(rig::SerialSession({}, {}, port_to(dead)), Catch::Contains("is their supply on"));
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
  rig::SerialLink::Bytes body(wire::kPulseRequestSize);
  wire::put_pulse_request(body.data(), &pulse);
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
