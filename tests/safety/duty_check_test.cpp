#include "lodestone/safety/duty_check.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("a coil that is on for too large a fraction of the time is not trusted") {
  const auto pulses_until_refused = [](double on_s, double period_s) {
    safety::DutyCheck check(0.5, 2.0, {});
    rig::CoilPulse pulse{{0.0, -1.0, 0.0, 0.0}, on_s};
    safety::PulseContext context;
    for (int count = 0; count < 100; ++count) {
      try {
        check.check(pulse, context);
      } catch (const safety::Distrust& distrust) {
        CHECK_THAT(distrust.what(),
                   Catch::Contains("coil -x would be on for more than 50 % of the time over 2 s"));
        return count;
      }
      context.last = pulse;
      context.on_s = on_s;
      context.passed_s = period_s;
    }
    return 100;
  };
  CHECK(pulses_until_refused(0.3, 0.3) == 6);  // always on: 0.15 s of excess per step, against 1 s
  CHECK(pulses_until_refused(0.14, 0.3) == 100);
}
