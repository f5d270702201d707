#include "lodestone/console/pulse_log.h"

#include <catch2/catch.hpp>

#include "control/fakes.h"
#include "lodestone/safety/supervisor.h"
#include "paper_rig.h"

using namespace lodestone;
using console::PulseLog;

TEST_CASE("the pulse log knows what is on, for how much of the time, and how evenly pulses come") {
  tests::RecordingCoils device;
  tests::ManualClock clock;
  device.state.temperature_C.assign(4, 22.0);
  safety::Supervisor supervisor(device, safety::SafetyConfig{}, tests::paper_rig(), clock,
                                safety::Supervisor::Poses::kNone);
  PulseLog log(supervisor, clock, 0.3, 4);
  const auto rest = [&](double time_s) { clock.sleep_until(clock.now_s() + time_s); };
  log.begin_run();
  CHECK_FALSE(log.jitter_s());
  log.apply({{2.0, 0.0, 0.0, -1.0}, 0.1});
  CHECK(device.pulses.size() == 1);
  rest(0.05);
  CHECK(log.on_A(clock.now_s())[0] == 2.0);
  CHECK(log.duty(clock.now_s())[3] == Approx(0.005));
  rest(0.25);
  CHECK(log.on_A(clock.now_s())[0] == 0.0);
  CHECK(log.duty(clock.now_s())[0] == Approx(0.01));
  CHECK(log.duty(clock.now_s())[1] == 0.0);
  log.apply({{0.0, 1.0, 0.0, 0.0}, 0.1});
  CHECK(log.jitter_s().value() == Approx(0.0).margin(1e-9));
  rest(0.02);
  log.stop();
  CHECK_FALSE(device.on);
  CHECK(log.on_A(clock.now_s())[1] == 0.0);
  rest(0.29);
  log.apply({{0.0, 1.0, 0.0, 0.0}, 0.1});
  CHECK(log.jitter_s().value() == Approx(0.01));
  CHECK(log.duty(clock.now_s())[1] == Approx(0.002));
  log.begin_run();
  CHECK_FALSE(log.jitter_s());
  rest(11.0);
  CHECK(log.duty(clock.now_s())[0] == 0.0);
}
